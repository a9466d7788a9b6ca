/** Materials of three.js whose vertices are drawn where they are seen, and whose colours are those of pictures. */

import { MeshStandardMaterial, Texture } from "three";

import colorsSource from "../effects/colors.glsl";
import headLightSource from "../effects/head_light.glsl";
import lightConeSource from "../light_cone/light_cone.glsl";
import roundSource from "../shape/round.glsl";
import roundUvSource from "../shape/round_uv.glsl";
import placeSource from "./place.glsl";
import vertexSource from "./vertex.glsl";

/**
 * Uniforms by name, shared by all materials of one mesh.
 * @typedef {Record<string, import("three").IUniform>} Uniforms
 */

/**
 * Names of GLSL and their values: each part of the program is compiled only where its name is there.
 * @typedef {Record<string, string | number>} Defines
 */

/** Samples of a texture along its steepest slope, at most: surfaces reach far away at glancing angles. */
const ANISOTROPY = 8;

const VERTEX_BEGINNING = `${roundSource}\n${vertexSource}\n${lightConeSource}\n${placeSource}`;

/** What takes the place of chunks of three.js in the vertex shader. */
const VERTEX_CHUNKS = {
    "#include <clipping_planes_pars_vertex>": `#include <clipping_planes_pars_vertex>\n${VERTEX_BEGINNING}`,
    "void main() {": "void main() {\nfindVertex();\nSighting sighting = sight(vertexPosition);",
    "#include <beginnormal_vertex>": `vec3 objectNormal = vertexNormal;
        if (fromOutside > 0.5) { objectNormal = upright * (turn * seenNormal(sighting, vertexNormal)); }`,
    "#include <defaultnormal_vertex>": "vec3 transformedNormal = objectNormal;",
    "#include <begin_vertex>": "vec3 transformed = eye + turn * sighting.seen;",
    // The direction to the eye is that of the frame in which the light is reckoned.
    "vViewPosition = - mvPosition.xyz;": `vViewPosition = fromOutside > 0.5 ? upright * (cameraPosition - transformed) : -sighting.offset;
        #if defined( DOPPLER_SPECTRUM ) || defined( DOPPLER_RAMP ) || defined( SEARCHLIGHT )
            vDoppler = sighting.doppler;
        #endif
        #if defined( ROUND )
            vOwnPlace = toShape * (vertexPosition - shapeOrigin);
        #endif`,
};

/** What takes the place of chunks of three.js in the fragment shader. */
const FRAGMENT_CHUNKS = {
    "#include <clipping_planes_pars_fragment>": `#include <clipping_planes_pars_fragment>
        ${headLightSource}
        ${colorsSource}
        #if defined( USE_MAP ) && ( defined( ROUND_SPHERE ) || defined( ROUND_TORUS ) )
            uniform vec2 shapeRadii;
            ${roundUvSource}
        #endif`,
    "#include <map_fragment>": `
        #if defined( USE_MAP ) && ( defined( ROUND_SPHERE ) || defined( ROUND_TORUS ) )
            vec2 mapUv = roundUv();
            #define vMapUv mapUv
        #endif
        #include <map_fragment>`,
    "#include <lights_physical_fragment>": "",
    "#include <lights_fragment_begin>": "",
    "#include <lights_fragment_maps>": "",
    "#include <lights_fragment_end>": "",
    "#include <aomap_fragment>": `float open = 1.0;
        #if defined( USE_AOMAP )
            open = (texture2D(aoMap, vAoMapUv).r - 1.0) * aoMapIntensity + 1.0;
        #endif`,
    "#include <opaque_fragment>": `
        #if defined( GHOST )
            // Like glass: clearer where it is seen head-on.
            float grazing = 1.0 - clamp(dot(normal, normalize(vViewPosition)), 0.0, 1.0);
            outgoingLight = diffuseColor.rgb;
            diffuseColor.a = 0.1 + 0.6 * grazing * grazing;
        #elif defined( BLACK_BODY )
            outgoingLight = shown(glow());
        #elif defined( UNLIT )
            outgoingLight = shown(lightOf(diffuseColor.rgb));
        #else
            vec2 reflected = headLight(Finish(metalnessFactor, roughnessFactor), normal, normalize(vViewPosition), open);
            vec3 light = lightOf(diffuseColor.rgb) * reflected.x + lightOf(vec3(1.0)) * reflected.y;
            if (totalEmissiveRadiance != vec3(0.0)) {
                light += lightOf(totalEmissiveRadiance);
            }
            outgoingLight = shown(light);
        #endif
        #include <opaque_fragment>`,
};

/**
 * Replaces chunks of a shader of three.js.
 * @param {string} source
 * @param {Record<string, string>} chunks
 * @throws {Error} If the shader lacks one of the chunks: this is another version of three.js.
 */
function withChunks(source, chunks) {
    return Object.entries(chunks).reduce((shader, [chunk, replacement]) => {
        if (!shader.includes(chunk)) {
            throw new Error(`the shader of three.js has no "${chunk}"`);
        }
        return shader.replace(chunk, () => replacement);
    }, source);
}

/**
 * A material that draws the vertices of one mesh where they are seen, made from what the file says of its surface.
 * @param {import("three").Material} source
 * @param {Uniforms} uniforms
 * @param {Defines} defines
 */
export function relativisticMaterial(source, uniforms, defines) {
    const material = new MeshStandardMaterial();
    if (source instanceof MeshStandardMaterial) {
        MeshStandardMaterial.prototype.copy.call(material, source);
        material.defines = { STANDARD: "", ...defines };
    } else {
        // Without light: a basic material has the maps of its colour alone.
        const { color, map, vertexColors, transparent, opacity, alphaTest, side, depthWrite } =
            /** @type {import("three").MeshBasicMaterial} */ (source);
        Object.assign(material, { map, vertexColors, transparent, opacity, alphaTest, side, depthWrite });
        material.color.copy(color);
        material.defines = { STANDARD: "", UNLIT: "", ...defines };
    }
    for (const value of Object.values(material)) {
        if (value instanceof Texture) {
            value.anisotropy = ANISOTROPY;
        }
    }
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, uniforms);
        shader.vertexShader = withChunks(shader.vertexShader, VERTEX_CHUNKS);
        shader.fragmentShader = withChunks(shader.fragmentShader, FRAGMENT_CHUNKS);
    };
    material.customProgramCacheKey = () => "photosurface";
    return material;
}
