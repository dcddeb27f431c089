# From files and a map to a dataset. Folders are asked for their time too, which changes when a file
# comes or goes.
raw := $(shell find '$(RAW)' ! -name '.*' ! -name 'README*' | sed 's/[] :*?[]/\\&/g')

$(subst $() ,\ ,$(DATASET))/dataset.toml: $(subst $() ,\ ,$(MAP)) $(raw) $(PROGRAM)
	$(TSAS) ingest '$(RAW)' --map '$(MAP)' --out '$(DATASET)' --force
