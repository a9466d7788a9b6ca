/** Positions read back from the vertex stage of the page, by transform feedback with the page's own vertex shaders. */

/**
 * For each mesh that the observer's view draws: the number of its piece, and up to `most` of its vertices, at rest relative
 * to the origin of its node (`rest`, three numbers each) and where they are drawn (`clip`, four numbers each).
 */
export function readBack(page, most) {
    return page.evaluate(readBackInPage, most);
}

function readBackInPage(most) {
    const viewer = globalThis.photosurface;
    const { world, views } = viewer;
    const gl = views.renderer.getContext();
    const results = [];
    const variants = new Map();
    const FLOATS = 7;

    /** The same program, but with what is read back. */
    function variantOf(program) {
        const known = variants.get(program);
        if (known) {
            return known;
        }
        const variant = gl.createProgram();
        for (const shader of gl.getAttachedShaders(program)) {
            const isVertex = gl.getShaderParameter(shader, gl.SHADER_TYPE) === gl.VERTEX_SHADER;
            const source = gl.getShaderSource(shader);
            const copy = gl.createShader(isVertex ? gl.VERTEX_SHADER : gl.FRAGMENT_SHADER);
            const parts = ["void main() {", "findVertex();"];
            if (isVertex && !source.includes(parts.join("\n"))) {
                throw new Error("the vertex shader does not begin with findVertex()");
            }
            const reading = ["out vec3 restPlace;", parts[0], parts[1], "restPlace = vertexPosition;"].join("\n");
            gl.shaderSource(copy, isVertex ? source.replace(parts.join("\n"), reading) : source);
            gl.compileShader(copy);
            gl.attachShader(variant, copy);
        }
        const attributes = gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES);
        for (let k = 0; k < attributes; k++) {
            const { name } = gl.getActiveAttrib(program, k);
            if (!name.startsWith("gl_")) {
                gl.bindAttribLocation(variant, gl.getAttribLocation(program, name), name);
            }
        }
        gl.transformFeedbackVaryings(variant, ["restPlace", "gl_Position"], gl.INTERLEAVED_ATTRIBS);
        gl.linkProgram(variant);
        if (!gl.getProgramParameter(variant, gl.LINK_STATUS)) {
            throw new Error(gl.getProgramInfoLog(variant));
        }
        variants.set(program, variant);
        return variant;
    }

    function copyUniforms(from, to) {
        const setters = new Map([
            [gl.FLOAT, "uniform1f"],
            [gl.FLOAT_VEC2, "uniform2fv"],
            [gl.FLOAT_VEC3, "uniform3fv"],
            [gl.FLOAT_VEC4, "uniform4fv"],
            [gl.INT, "uniform1i"],
            [gl.BOOL, "uniform1i"],
            [gl.SAMPLER_2D, "uniform1i"],
            [gl.SAMPLER_3D, "uniform1i"],
            [gl.FLOAT_MAT3, "uniformMatrix3fv"],
            [gl.FLOAT_MAT4, "uniformMatrix4fv"],
        ]);
        const count = gl.getProgramParameter(to, gl.ACTIVE_UNIFORMS);
        for (let k = 0; k < count; k++) {
            const { name, type } = gl.getActiveUniform(to, k);
            const [source, target] = [from, to].map((program) => gl.getUniformLocation(program, name));
            const setter = setters.get(type);
            if (!source || !target || !setter) {
                throw new Error(`the uniform ${name} cannot be copied`);
            }
            const value = gl.getUniform(from, source);
            setter.startsWith("uniformMatrix") ? gl[setter](target, false, value) : gl[setter](target, value);
        }
    }

    /** Runs the vertex stage of the mesh that is about to be drawn. */
    function read(piece, mesh) {
        const program = gl.getParameter(gl.CURRENT_PROGRAM);
        const variant = variantOf(program);
        const { attributes, instanceCount } = mesh.geometry;
        const instances = mesh.geometry.isInstancedBufferGeometry ? instanceCount : 1;
        const each = (attributes.pattern ?? attributes.position).count;
        const buffer = gl.createBuffer();
        const feedback = gl.createTransformFeedback();
        gl.useProgram(variant);
        copyUniforms(program, variant);
        gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, feedback);
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
        gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, each * instances * FLOATS * 4, gl.STREAM_READ);
        gl.enable(gl.RASTERIZER_DISCARD);
        gl.beginTransformFeedback(gl.POINTS);
        gl.drawArraysInstanced(gl.POINTS, 0, each, instances);
        gl.endTransformFeedback();
        gl.disable(gl.RASTERIZER_DISCARD);
        const numbers = new Float32Array(each * instances * FLOATS);
        gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, numbers);
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
        gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, null);
        gl.deleteTransformFeedback(feedback);
        gl.deleteBuffer(buffer);
        gl.useProgram(program);
        const step = Math.max(Math.ceil((each * instances) / most), 1);
        const [rest, clip] = [[], []];
        for (let vertex = 0; vertex < each * instances; vertex += step) {
            const at = vertex * FLOATS;
            rest.push(...numbers.subarray(at, at + 3));
            clip.push(...numbers.subarray(at + 3, at + FLOATS));
        }
        results.push({ piece, isLeaf: attributes.pattern !== undefined, vertices: each * instances, rest, clip });
    }

    let current = null;
    const undo = [];
    world.group.children.forEach((group, piece) => {
        for (const mesh of group.children) {
            const own = mesh.onBeforeRender;
            mesh.onBeforeRender = (...args) => {
                own(...args);
                current = { piece, mesh };
            };
            undo.push(() => {
                mesh.onBeforeRender = own;
            });
        }
    });
    for (const name of ["drawElements", "drawElementsInstanced"]) {
        gl[name] = () => {
            if (current) {
                read(current.piece, current.mesh);
                current = null;
            }
        };
        undo.push(() => delete gl[name]);
    }
    try {
        viewer.drawNow();
    } finally {
        for (const each of undo) {
            each();
        }
        for (const variant of variants.values()) {
            gl.deleteProgram(variant);
        }
    }
    const error = gl.getError();
    if (error !== gl.NO_ERROR) {
        throw new Error(`WebGL error ${error}`);
    }
    const { projectionMatrix, matrixWorld } = views.observer;
    return { results, projection: projectionMatrix.toArray(), camera: matrixWorld.toArray() };
}
