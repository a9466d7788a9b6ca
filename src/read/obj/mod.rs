//! OBJ files and their material libraries.

mod lines;
mod model;
mod mtl;
mod mtl_map;
mod mtl_pack;
mod ordinary;
mod packing;

pub(super) use model::read_obj_bytes;
