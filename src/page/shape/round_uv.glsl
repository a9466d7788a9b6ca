// Texture coordinates of spheres and tori at every pixel: between the corners of a facet they are not linear, at the poles of
// a sphere not even continuous.

varying vec3 vOwnPlace;

const float TURN = 6.283185307179586;

// The part of a full turn about the axis, from 0 to 1.
float turnOf(vec3 place) {
    return fract(atan(-place.x, -place.z) / TURN);
}

// A coordinate that begins again at 1, shifted where it does, so that its slope picks the right picture of the texture.
float withoutSeam(float coordinate) {
    float shifted = fract(coordinate + 0.5) - 0.5;
    return fwidth(coordinate) <= fwidth(shifted) + 1e-5 ? coordinate : shifted;
}

vec2 roundUv() {
    float around = withoutSeam(turnOf(vOwnPlace));
    #if defined( ROUND_SPHERE )
        return vec2(around, acos(clamp(normalize(vOwnPlace).y, -1.0, 1.0)) / (0.5 * TURN));
    #else
        float outward = length(vOwnPlace.xz) - shapeRadii.x;
        return vec2(around, withoutSeam(fract(atan(vOwnPlace.y, -outward) / TURN)));
    #endif
}
