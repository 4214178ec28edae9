"""Weight functions: each gives logits, and `softmax(logits / T)` are the weights of moving least squares."""

from neuralmls.weights.function import HasLogits, NetworkWeights, Weights
from neuralmls.weights.inverse_distance import InverseDistanceWeights
from neuralmls.weights.neural import NeuralWeights
from neuralmls.weights.shape_aware import ShapeAwareWeights
from neuralmls.weights.softmax import softmax

__all__ = [
    "HasLogits",
    "InverseDistanceWeights",
    "NetworkWeights",
    "NeuralWeights",
    "ShapeAwareWeights",
    "Weights",
    "softmax",
]
