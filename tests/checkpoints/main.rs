//! Checkpoints: a resumed run takes the same steps to the last bit, whatever its map remembers; checkpoints that do not belong to a
//! simulation are refused; a process that is killed loses nothing but the steps since its last one.

#[path = "../../examples/checkpoint/file.rs"]
mod file;
mod killed;
mod members;
mod refusals;
