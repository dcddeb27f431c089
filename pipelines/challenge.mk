# The blind benchmark: this program's diagnosis and three baselines on the same sealed recordings.
#
# make challenge                             one seed for scoring: hours on two cores
# make challenge CHALLENGE_TOOLS=diagnose    this program alone
# make challenge CHALLENGE_PART='--conditions clean --kind near'
# make challenge SEED=10100 SEEDS=3          others, and more of them
# make challenge-nothing SEED=10200          300 cases in which nothing is hidden: a quarter of an hour
SEED ?= 10000
SEEDS ?= 1
CHALLENGE_OUT ?= reports/challenge
CHALLENGE_TOOLS := diagnose bic training sparse

.PHONY: challenge challenge-nothing challenge-ci challenge-table
challenge: challenge-table  ## make a sealed set, let every tool diagnose it, print the table of scores

challenge-nothing: SEEDS = 30
challenge-nothing: CHALLENGE_OUT = reports/challenge-nothing
challenge-nothing: CHALLENGE_PART = --kind nothing --conditions clean
challenge-nothing: CHALLENGE_TOOLS = diagnose
challenge-nothing: challenge-table  ## how often something is named where nothing is hidden, in 300 cases

# Always the same: a seed for building, each effect once, a few cases of what is none.
challenge-ci: SEED = 3
challenge-ci: SEEDS = 1
challenge-ci: CHALLENGE_OUT = reports/challenge-ci
challenge-ci: CHALLENGE_PART = --small --rate 100 --salt 0
challenge-ci: challenge-table  ## the same on a small fixed set

challenge-table: setup
	$(TSAS) challenge make --seed $(SEED) --seeds $(SEEDS) $(CHALLENGE_PART) --out '$(call name,CHALLENGE_OUT)/set' --force
	@for tool in $(CHALLENGE_TOOLS); do \
		$(TSAS) challenge run '$(CHALLENGE_OUT)/set' --tool $$tool --out '$(CHALLENGE_OUT)'/$$tool --force || exit; \
	done
	$(TSAS) challenge score '$(CHALLENGE_OUT)/set' $(CHALLENGE_TOOLS:%='$(CHALLENGE_OUT)/%') --out '$(CHALLENGE_OUT)/score' --force
