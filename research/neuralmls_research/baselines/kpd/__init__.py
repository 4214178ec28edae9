"""KeypointDeformer (Jakab et al., CVPR 2021) by NumPy: inference alone, without a deep-learning framework.

The way of the data: normalise -> keypoints, influence (`network.py`) -> cage (`cage.py`) -> mean value coordinates
(`mean_value.py`) -> deform (`model.py`). `checkpoint.py` converts published weights without running what is in them.
"""

from neuralmls_research.baselines.kpd.model import BoundKeypoints, KeypointDeformer

__all__ = ["BoundKeypoints", "KeypointDeformer"]
