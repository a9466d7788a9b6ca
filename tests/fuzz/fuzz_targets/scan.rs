#![no_main]

photosurface_fuzz::fuzz!(scan);
