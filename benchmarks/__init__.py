"""What has to be fast: each module here has `measure() -> Iterable[Row]`; `make bench` runs all."""
