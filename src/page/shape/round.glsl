// Round shapes: the places between the corners of a facet are moved onto the sphere, torus or surface of revolution that the
// facet stands for.

#if defined( ROUND_SPHERE ) || defined( ROUND_TORUS ) || defined( ROUND_LATHE )
    #define ROUND

    // From the shape's own coordinates, in which its axis is y, to those of the mesh, and back: scale, then rotation.
    uniform mat3 fromShape;
    uniform mat3 toShape;
    // The origin of the shape in the coordinates of the mesh.
    uniform vec3 shapeOrigin;
    // The radius of a sphere; the major and the minor radius of a torus.
    uniform vec2 shapeRadii;

    // A place of a facet and its normal in the shape's own coordinates, with their distances from the axis.
    struct RoundPlace {
        vec3 place;
        vec3 normal;
        float fromAxis;
        float normalAside;
    };

    RoundPlace roundPlace(vec3 place, vec3 normal) {
        vec3 own = toShape * (place - shapeOrigin);
        vec3 ownNormal = normalize(normal * fromShape);
        return RoundPlace(own, ownNormal, length(own.xz), length(ownNormal.xz));
    }

    // The place between three corners with these weights, before it is moved onto the surface. The order of the sums is
    // the same for both facets at an edge, since the corners of every facet come in one order.
    RoundPlace between(RoundPlace a, RoundPlace b, RoundPlace c, vec3 weights) {
        return RoundPlace(
            weights.x * a.place + weights.y * b.place + weights.z * c.place,
            weights.x * a.normal + weights.y * b.normal + weights.z * c.normal,
            weights.x * a.fromAxis + weights.y * b.fromAxis + weights.z * c.fromAxis,
            weights.x * a.normalAside + weights.y * b.normalAside + weights.z * c.normalAside
        );
    }

    vec2 directionAside(vec3 vector) {
        return vector.xz / max(length(vector.xz), 1e-30);
    }

    // Moves a place and its normal onto the true surface; both come back in the coordinates of the mesh.
    void ontoSurface(RoundPlace flatPlace, out vec3 place, out vec3 normal) {
        vec3 own = flatPlace.place;
        vec3 ownNormal = flatPlace.normal;
        #if defined( ROUND_SPHERE )
            ownNormal = normalize(own);
            own = ownNormal * shapeRadii.x;
        #elif defined( ROUND_TORUS )
            vec2 aside = directionAside(own);
            vec3 middle = vec3(aside.x, 0.0, aside.y) * shapeRadii.x;
            ownNormal = normalize(own - middle);
            own = middle + ownNormal * shapeRadii.y;
        #else
            own.xz = directionAside(own) * flatPlace.fromAxis;
            ownNormal.xz = directionAside(ownNormal) * flatPlace.normalAside;
        #endif
        place = fromShape * own + shapeOrigin;
        normal = normalize(ownNormal * toShape);
    }
#endif
