//! Weight functions, each as a logit function: `w = softmax(logits(x) / T)`.
//!
//! MLS does not change when the weights of a point are normalised (Proposition 1 of the paper), so the classic weights are
//! a softmax too, and neural, classic and any later weights share one path.

pub mod inverse_distance;
pub mod neural;
