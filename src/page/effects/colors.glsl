// From the light of a surface at rest to the light that a screen shows: what the effects that are on make of it. The formulas are
// those of `src/effects/seen_light.rs`, the tables are made by the library.

#if defined( DOPPLER_SPECTRUM ) || defined( DOPPLER_RAMP ) || defined( SEARCHLIGHT )
    // Frequency seen over frequency emitted.
    varying float vDoppler;
    // Of a white surface in shifted daylight: the hue at luminance 1, and the binary logarithm of the luminance; in even steps of
    // the binary logarithm of the factor from `whiteRange.x` to `whiteRange.y`.
    uniform highp sampler2D whiteLight;
    uniform vec2 whiteRange;

    vec4 whiteAt(float octaves) {
        int last = textureSize(whiteLight, 0).x - 1;
        float place = clamp((octaves - whiteRange.x) / (whiteRange.y - whiteRange.x), 0.0, 1.0) * float(last);
        int first = min(int(place), last - 1);
        vec4 low = texelFetch(whiteLight, ivec2(first, 0), 0);
        vec4 high = texelFetch(whiteLight, ivec2(first + 1, 0), 0);
        vec4 white = mix(low, high, place - float(first));
        // Beyond its ends the logarithm goes on straight.
        float beyond = octaves - clamp(octaves, whiteRange.x, whiteRange.y);
        white.w += beyond * (high.w - low.w) * float(last) / (whiteRange.y - whiteRange.x);
        return white;
    }

    float octavesSeen() {
        return log2(max(vDoppler, 1e-30));
    }
#endif

// Luminance of linear sRGB.
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);
// Where the tone curve begins to compress, and how quickly brighter light turns white.
const float COMPRESSED_FROM = 0.8;
const float DESATURATION = 0.15;

// Light of `stops` more than none: what is beyond every screen stays finite.
float brighter(float octaves) {
    return exp2(clamp(octaves, -60.0, 60.0));
}

#if defined( DOPPLER_SPECTRUM ) || defined( SEARCHLIGHT )
    // What the light of a surface has beside that of a grey one, channel by channel: colours in a cube with even square roots,
    // one cube for each factor.
    uniform highp sampler3D colorTable;
    uniform vec4 colorRange; // Binary logarithms of the first and the last factor, number of factors, scale.

    vec3 entryAt(ivec3 place) {
        vec3 root = (texelFetch(colorTable, place, 0).rgb * 255.0 - 128.0) / 127.0;
        return root * abs(root) * colorRange.w;
    }

    // Linear in each of the six tetrahedra of a cube around its grey diagonal.
    vec3 restAt(vec3 root, int factor) {
        int side = textureSize(colorTable, 0).x;
        vec3 cell = root * float(side - 1);
        ivec3 corner = min(ivec3(cell), side - 2);
        vec3 part = cell - vec3(corner);
        corner.z += factor * side;
        float most = max(part.x, max(part.y, part.z));
        float least = min(part.x, min(part.y, part.z));
        float middle = part.x + part.y + part.z - most - least;
        ivec3 first = most == part.x ? ivec3(1, 0, 0) : most == part.y ? ivec3(0, 1, 0) : ivec3(0, 0, 1);
        ivec3 last = least == part.z ? ivec3(0, 0, 1) : least == part.y ? ivec3(0, 1, 0) : ivec3(1, 0, 0);
        return entryAt(corner) * (1.0 - most) + entryAt(corner + first) * (most - middle)
            + entryAt(corner + 1 - last) * (middle - least) + entryAt(corner + 1) * least;
    }

    // The light of a surface of this colour, channels from 0 to 1, over the luminance of a white one.
    vec3 shiftedLight(vec3 color, float octaves, vec3 hue) {
        float place = clamp((octaves - colorRange.x) / (colorRange.y - colorRange.x), 0.0, 1.0) * (colorRange.z - 1.0);
        int first = min(int(place), int(colorRange.z) - 2);
        vec3 root = sqrt(color);
        vec3 rest = mix(restAt(root, first), restAt(root, first + 1), place - float(first));
        if (octaves >= colorRange.x && octaves <= colorRange.y) {
            return color * hue + rest;
        }
        // Beyond, all that is visible was beyond the wavelengths of which colours speak: grey.
        vec3 end = whiteAt(clamp(octaves, colorRange.x, colorRange.y)).rgb;
        return hue * clamp(dot(color * end + rest, LUMINANCE), 0.0, 1.0);
    }
#endif

#if defined( DOPPLER_RAMP )
    uniform sampler2D ramp;
    uniform vec2 rampRange;

    vec3 rampColor() {
        float count = float(textureSize(ramp, 0).x);
        float part = clamp((octavesSeen() - rampRange.x) / (rampRange.y - rampRange.x), 0.0, 1.0);
        return texture(ramp, vec2((part * (count - 1.0) + 0.5) / count, 0.5)).rgb;
    }
#endif

// The light of a surface of this colour in daylight at rest with it, before the exposure.
vec3 lightOf(vec3 color) {
    #if defined( DOPPLER_RAMP ) && defined( SEARCHLIGHT )
        return rampColor() * brighter(whiteAt(octavesSeen()).w);
    #elif defined( DOPPLER_RAMP )
        return rampColor();
    #elif defined( DOPPLER_SPECTRUM ) || defined( SEARCHLIGHT )
        color = max(color, vec3(0.0));
        float times = max(max(color.r, color.g), max(color.b, 1.0));
        color /= times;
        float octaves = octavesSeen();
        vec4 white = whiteAt(octaves);
        vec3 shifted = shiftedLight(color, octaves, white.rgb);
        #if !defined( SEARCHLIGHT )
            float seen = dot(shifted, LUMINANCE);
            return seen > 0.0 ? shifted * (dot(color, LUMINANCE) / seen * times) : vec3(0.0);
        #elif defined( DOPPLER_SPECTRUM )
            return shifted * (times * brighter(white.w));
        #else
            float atRest = dot(color, LUMINANCE);
            float seen = max(dot(shifted, LUMINANCE), 0.0);
            return atRest > 0.0 ? color * (seen / atRest * times * brighter(white.w)) : vec3(0.0);
        #endif
    #else
        return color;
    #endif
}

#if defined( BLACK_BODY )
    // Binary logarithm of its temperature over that of daylight; its luminance at rest.
    uniform vec2 blackBody;
    uniform vec3 blackBodyHue;

    // The light that a black body emits.
    vec3 glow() {
        #if defined( DOPPLER_SPECTRUM ) || defined( DOPPLER_RAMP ) || defined( SEARCHLIGHT )
            vec4 white = whiteAt(blackBody.x + octavesSeen());
            #if defined( DOPPLER_SPECTRUM )
                vec3 hue = white.rgb;
            #elif defined( DOPPLER_RAMP )
                vec3 hue = rampColor();
            #else
                vec3 hue = blackBodyHue;
            #endif
            #if defined( SEARCHLIGHT )
                return hue * (blackBody.y * brighter(white.w - whiteAt(blackBody.x).w));
            #else
                return hue * blackBody.y;
            #endif
        #else
            return blackBodyHue * blackBody.y;
        #endif
    }
#endif

// Twice as bright for each stop.
uniform float exposureFactor;

// Light as a screen shows it, channels from 0 to 1: what no screen shows goes towards grey, what is too bright towards white.
// See `src/effects/gamut.rs`.
vec3 shown(vec3 light) {
    #if defined( EFFECTS )
        vec3 color = light * exposureFactor;
        float grey = dot(color, LUMINANCE);
        float least = min(color.r, min(color.g, color.b));
        if (least < 0.0) {
            color = grey > 0.0 ? max(mix(vec3(grey), color, grey / (grey - least)), vec3(0.0)) : vec3(0.0);
        }
        float peak = max(color.r, max(color.g, color.b));
        if (peak > COMPRESSED_FROM) {
            float room = 1.0 - COMPRESSED_FROM;
            float compressed = 1.0 - room * room / (peak + room - COMPRESSED_FROM);
            float whiter = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
            color = mix(color / peak * compressed, vec3(compressed), whiter);
        }
        return color;
    #else
        return light;
    #endif
}
