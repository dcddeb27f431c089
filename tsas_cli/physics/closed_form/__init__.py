"""The static and the distributed model in closed form: a spring load, constant friction."""
