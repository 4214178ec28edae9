"""What measures NeuralMLS: other methods, metrics, and the paper's experiments, on the public names of `neuralmls`."""
