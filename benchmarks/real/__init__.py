"""Public recordings of others: what a model that learns from some of them predicts of the rest."""
