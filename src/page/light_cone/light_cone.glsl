// Where a vertex is seen, in the axes of the rest frame of its object, relative to the eye: light-cone coordinates, which keep
// their digits at every speed. See `src/light_cone/map.rs` for the derivation.

// The place of the mesh relative to the eye, in the rest frame, as the sum of two numbers each.
uniform vec3 pivotHigh;
uniform vec3 pivotLow;
// Unit vector of the eye's motion in the rest frame, as the sum of two numbers each.
uniform vec3 motion;
uniform vec3 motionLow;
// exp(rapidity), exp(-rapidity).
uniform vec2 stretch;
// One. It keeps compilers from rearranging sums whose order matters.
uniform float one;

struct Sighting {
    // From the eye to the vertex, in the rest frame.
    vec3 offset;
    // Where the vertex is seen, before the axes turn.
    vec3 seen;
    // Frequency seen over frequency emitted.
    float doppler;
};

// The light-cone coordinates r - along and r + along, each without cancellation.
vec2 lightConeCoordinates(float along, float across2) {
    float r = sqrt(along * along + across2);
    float large = max(r + abs(along), 1e-30);
    float small = across2 / large;
    return along > 0.0 ? vec2(small, large) : vec2(large, small);
}

// The rounding error of `sum = a + b` (Knuth).
vec3 sumError(vec3 a, vec3 b, vec3 sum) {
    vec3 rounded = sum * one - a;
    return (a - (sum - rounded) * one) + (b - rounded);
}

// The rounding error of `product = a * b` (Dekker): halves of 12 bits have exact products.
vec3 productError(vec3 a, vec3 b, vec3 product) {
    vec3 largeA = a * 4097.0;
    vec3 largeB = b * 4097.0;
    vec3 highA = largeA * one - (largeA - a);
    vec3 highB = largeB * one - (largeB - b);
    vec3 lowA = a - highA;
    vec3 lowB = b - highB;
    return lowA * lowB - (((product * one - highA * highB) - lowA * highB) - highA * lowB);
}

// Splits the offset of a vertex into its parts along and across the motion. Nearly straight behind a fast eye the part across is
// small and decides everything, so it is found with twice the digits: all errors of the first roundings are added again.
void splitOffset(vec3 place, out float along, out vec3 across) {
    vec3 offset = place + pivotHigh;
    vec3 offsetLow = sumError(place, pivotHigh, offset) + pivotLow;
    vec3 products = offset * motion;
    vec3 errors = productError(offset, motion, products) + (offset * motionLow + offsetLow * motion);
    float first = products.x + products.y;
    float firstError = sumError(vec3(products.x), vec3(products.y), vec3(first)).x;
    along = first + products.z;
    float alongLow = sumError(vec3(first), vec3(products.z), vec3(along)).x + firstError + (errors.x + errors.y + errors.z);
    vec3 parallel = motion * along;
    vec3 parallelLow = productError(motion, vec3(along), parallel) + (motion * alongLow + motionLow * along);
    across = offset - parallel;
    across += sumError(offset, -parallel, across) + (offsetLow - parallelLow);
}

Sighting sight(vec3 place) {
    float along;
    vec3 across;
    splitOffset(place, along, across);
    float across2 = dot(across, across);
    vec2 atRest = lightConeCoordinates(along, across2);
    vec2 boosted = atRest * stretch.yx;
    Sighting sighting;
    sighting.offset = across + motion * along;
    sighting.doppler = (boosted.x + boosted.y) / max(atRest.x + atRest.y, 1e-30);
    #if defined( MODEL_SEEN )
        sighting.seen = across + motion * (0.5 * (boosted.y - boosted.x));
    #elif defined( MODEL_DELAYED )
        // The photosurface of an object that is not contracted is that of one which is longer by the Lorentz factor.
        vec2 longer = lightConeCoordinates(along * 0.5 * (stretch.x + stretch.y), across2) * stretch.yx;
        sighting.seen = across + motion * (0.5 * (longer.y - longer.x));
    #elif defined( MODEL_CONTRACTED )
        sighting.seen = across + motion * (2.0 * along / (stretch.x + stretch.y));
    #else
        sighting.seen = sighting.offset;
    #endif
    return sighting;
}

// The normal of the photosurface, before the axes turn, where the surface at rest has the unit normal `normal`.
vec3 seenNormal(Sighting sighting, vec3 normal) {
    #if defined( MODEL_SEEN )
        float gamma = 0.5 * (stretch.x + stretch.y);
        float momentum = 0.5 * (stretch.x - stretch.y);
        vec3 toVertex = sighting.offset / max(length(sighting.offset), 1e-30);
        vec3 slope = (gamma - 1.0) * motion + momentum * toVertex;
        return normalize(normal - slope * (dot(motion, normal) / sighting.doppler));
    #elif defined( MODEL_DELAYED )
        float gamma = 0.5 * (stretch.x + stretch.y);
        float momentum = 0.5 * (stretch.x - stretch.y);
        vec3 longer = sighting.offset + motion * ((gamma - 1.0) * dot(motion, sighting.offset));
        vec3 toVertex = longer / max(length(longer), 1e-30);
        // Normals of the stand-in, then of its photosurface.
        vec3 stood = normal + motion * ((1.0 / gamma - 1.0) * dot(motion, normal));
        vec3 slope = (gamma - 1.0) * motion + momentum * toVertex;
        float factor = gamma + momentum * dot(motion, toVertex);
        return normalize(stood - slope * (dot(motion, stood) / factor));
    #elif defined( MODEL_CONTRACTED )
        float gamma = 0.5 * (stretch.x + stretch.y);
        return normalize(normal + motion * ((gamma - 1.0) * dot(motion, normal)));
    #else
        return normal;
    #endif
}
