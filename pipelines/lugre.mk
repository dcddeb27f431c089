# The tight reference solutions of the dynamic model, by two general solvers that share no code with
# it (benchmarks/lugre_rivals); a few minutes.
.PHONY: lugre-references
lugre-references: setup  ## make the dynamic model's reference solutions again
	@$(BIN)/python -m benchmarks.lugre_rivals.references
