"""The one family of errors: each message is one sentence, what was wrong, where, what was expected."""


class NeuralMLSError(ValueError):
    """Anything that this package refuses; the message is one sentence that can be shown as it is."""


class FileError(NeuralMLSError):
    """A file that is missing, broken or of an unsupported kind, or that cannot be written."""


class ControlPointError(NeuralMLSError):
    """Control points that cannot be used: none, repeated, not finite, of mixed dimensions."""


class ArgumentError(NeuralMLSError):
    """An option or argument out of its range; the command line exits with 2, for the others with 1."""


class NotApplicable(NeuralMLSError):
    """A method of deformation that the shape or its control points do not meet the conditions of; it says which."""
