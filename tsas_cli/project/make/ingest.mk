# From files and a map to a dataset. No name of a file in RAW appears here: `find` tests whether a
# file is newer than the dataset, or a folder, whose time changes when a file is added or removed.
newer := $(shell test ! -e '$(DATASET)/dataset.toml' || test -z "$$(find -L '$(call name,RAW)' ! -name '.*' ! -name 'README*' -newer '$(DATASET)/dataset.toml' | head -n 1)" || echo newer-files)
.PHONY: newer-files

$(data)/dataset.toml: $(call target,MAP) $(newer) $(call stamp,ingest,$(RAW) $(MAP) $(DATASET)) $(PROGRAM)
	$(TSAS) ingest '$(RAW)' --map '$(MAP)' --out '$(DATASET)' --force
