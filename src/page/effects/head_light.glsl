// The light of a surface that a lamp at the eye and even surroundings light, as pictures of the command have it: see
// `src/render/shading.rs`. All vectors are of the frame in which the surface is at rest.

// The light of the surroundings that a gloss sends to the eye, by the square root of the cosine and by the roughness: the
// part in the colour of the surface and the white part.
uniform sampler2D albedo;
// How bright the lamp is; the radiance of the surroundings at the horizon, and how much more it is above.
uniform vec3 brightness;

const float DIELECTRIC = 0.04;
const float LEAST_ROUGHNESS = 0.1;

struct Finish {
    float metal;
    float roughness;
};

// The part in the colour of the surface, and the white part.
vec2 fromLampAtEye(Finish finish, float cosine) {
    float alpha = max(finish.roughness, LEAST_ROUGHNESS);
    alpha *= alpha;
    float square = alpha * alpha;
    float slant = cosine + sqrt(square + (1.0 - square) * cosine * cosine);
    float spread = cosine * cosine * (square - 1.0) + 1.0;
    float gloss = square * cosine / (spread * spread * slant * slant);
    return vec2(
        (1.0 - finish.metal) * (1.0 - DIELECTRIC) * cosine + finish.metal * gloss,
        (1.0 - finish.metal) * DIELECTRIC * gloss
    );
}

vec2 fromAllAround(Finish finish, float cosine, float ground, float gloss) {
    vec2 place = vec2(10.0 * sqrt(cosine) + 0.5, 10.0 * finish.roughness - 0.5) / vec2(11.0, 10.0);
    vec2 sent = texture2D(albedo, place).rg;
    float dielectric = DIELECTRIC * sent.x + sent.y;
    return vec2(
        (1.0 - finish.metal) * (1.0 - dielectric) * ground + finish.metal * sent.x * gloss,
        ((1.0 - finish.metal) * dielectric + finish.metal * sent.y) * gloss
    );
}

vec2 headLight(Finish finish, vec3 normal, vec3 toEye, float open) {
    float cosine = clamp(dot(normal, toEye), 0.0, 1.0);
    float mirror = 2.0 * cosine * normal.y - toEye.y;
    float ground = brightness.y + brightness.z * normal.y * 2.0 / 3.0;
    float gloss = brightness.y + brightness.z * mirror * (1.0 - finish.roughness / 3.0);
    return fromLampAtEye(finish, cosine) * brightness.x + fromAllAround(finish, cosine, ground, gloss) * open;
}
