// The vertex at hand: one of the mesh, or one of a leaf, which is a part of a triangle of the mesh that is drawn in pieces.

vec3 vertexPosition;
vec3 vertexNormal;

#if defined( LEAF )
    // Numbers of the three vertices of the triangle in the mesh, and how often the edges of the leaf are halved: two bits each.
    attribute vec4 leafTriangle;
    // The second and third barycentric coordinates of the first and of the second corner of the leaf, and of the third.
    attribute vec4 leafCorners;
    attribute vec2 leafCorner;
    // The weights of the second and the third corner of the leaf.
    attribute vec2 pattern;
    // The vertices of the mesh: position and u, normal and v, and as the mesh has them colour, and the second set of u, v.
    uniform highp sampler2D vertexTable;

    vec4 vertexUvs;
    vec4 vertexColor;

    vec4 tableEntry(float vertex, int column) {
        int entry = int(vertex) * TABLE_COLUMNS + column;
        return texelFetch(vertexTable, ivec2(entry % TABLE_WIDTH, entry / TABLE_WIDTH), 0);
    }

    // A part of an edge, from 0 to 1, moved down to the pieces that the edge has on both of its sides.
    float ontoEdge(float part, int halvings) {
        float pieces = float(1 << halvings);
        return floor(part * pieces + 0.001) / pieces;
    }

    // The barycentric coordinates of this vertex in the triangle. All numbers are multiples of a power of two, so that
    // the sums are exact and neighbours agree.
    vec3 leafWeights() {
        int halvings = int(leafTriangle.w);
        vec2 weights = pattern;
        float first = 1.0 - pattern.x - pattern.y;
        if (pattern.y == 0.0) {
            weights.x = ontoEdge(pattern.x, halvings & 3);
        } else if (first == 0.0) {
            weights.y = ontoEdge(pattern.y, (halvings >> 2) & 3);
            weights.x = 1.0 - weights.y;
        } else if (pattern.x == 0.0) {
            weights.y = 1.0 - ontoEdge(first, (halvings >> 4) & 3);
        }
        vec2 place = (1.0 - weights.x - weights.y) * leafCorners.xy + weights.x * leafCorners.zw + weights.y * leafCorner;
        return vec3(1.0 - place.x - place.y, place);
    }

    void findVertex() {
        vec3 weights = leafWeights();
        vec4 a = tableEntry(leafTriangle.x, 0), b = tableEntry(leafTriangle.y, 0), c = tableEntry(leafTriangle.z, 0);
        vec4 d = tableEntry(leafTriangle.x, 1), e = tableEntry(leafTriangle.y, 1), f = tableEntry(leafTriangle.z, 1);
        #if defined( ROUND )
            RoundPlace flatPlace = between(roundPlace(a.xyz, d.xyz), roundPlace(b.xyz, e.xyz), roundPlace(c.xyz, f.xyz), weights);
            ontoSurface(flatPlace, vertexPosition, vertexNormal);
        #else
            vertexPosition = weights.x * a.xyz + weights.y * b.xyz + weights.z * c.xyz;
            vertexNormal = weights.x * d.xyz + weights.y * e.xyz + weights.z * f.xyz;
        #endif
        vertexUvs.x = dot(weights, vec3(a.w, b.w, c.w));
        vertexUvs.y = dot(weights, vec3(d.w, e.w, f.w));
        #if defined( TABLE_COLOR )
            vertexColor = weights.x * tableEntry(leafTriangle.x, TABLE_COLOR)
                + weights.y * tableEntry(leafTriangle.y, TABLE_COLOR) + weights.z * tableEntry(leafTriangle.z, TABLE_COLOR);
        #endif
        #if defined( TABLE_UV1 )
            vertexUvs.zw = weights.x * tableEntry(leafTriangle.x, TABLE_UV1).xy
                + weights.y * tableEntry(leafTriangle.y, TABLE_UV1).xy + weights.z * tableEntry(leafTriangle.z, TABLE_UV1).xy;
        #endif
    }
    // The names that three.js has for what the mesh brings.
    #define uv vertexUvs.xy
    #define uv1 vertexUvs.zw
    #if defined( USE_COLOR_ALPHA )
        #define color vertexColor
    #else
        #define color vertexColor.rgb
    #endif
#else
    void findVertex() {
        #if defined( ROUND )
            ontoSurface(roundPlace(position, normal), vertexPosition, vertexNormal);
        #else
            vertexPosition = position;
            vertexNormal = normal;
        #endif
    }
#endif
