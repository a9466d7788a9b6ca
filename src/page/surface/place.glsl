// Vertices that a leaf shares with a whole triangle come out the same in both programs.
invariant gl_Position;

// Where the vertex is drawn: the axes of the picture are the observer's own, the observer at their origin.

// From the axes of the rest frame, boosted by the motion, to the observer's own.
uniform mat3 turn;
// The place of the eye: the observer's, or one of two in stereo.
uniform vec3 eye;
// 1 where the photosurface is looked at from outside, 0 where it is seen by the observer.
uniform float fromOutside;
// From the observer's own axes to those of the scene under the boost: light falls from above in the view from outside.
uniform mat3 upright;

#if defined( DOPPLER_SPECTRUM ) || defined( DOPPLER_RAMP ) || defined( SEARCHLIGHT )
    varying float vDoppler;
#endif
#if defined( ROUND )
    // The place in the shape's own coordinates.
    varying vec3 vOwnPlace;
#endif
