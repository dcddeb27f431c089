"""tsas: from recordings of a tendon-sheath rig to a model whose errors have names."""

__version__ = "0.1.0"
