//! glTF and GLB: small files made here, and the real ones of the data folder.

#[path = "gltf/builder.rs"]
mod builder;
#[path = "gltf/corpus.rs"]
mod corpus;
#[path = "gltf/hostile.rs"]
mod hostile;
#[path = "gltf/reading.rs"]
mod reading;
#[path = "gltf/writing.rs"]
mod writing;
