# Every stage and whole pipelines ended at chosen and at random moments, and what they leave judged.
#
# make torture                               600 trials
# make torture KILLS=100 TORTURE_SEED=2      fewer, other moments
KILLS ?= 600
TORTURE_SEED ?= 1

.PHONY: torture
torture: setup  ## kill every stage hundreds of times; inputs stay, outputs are whole or absent
	@$(BIN)/python -m tests.torture --kills $(KILLS) --seed $(TORTURE_SEED) --out reports/torture/torture.json
