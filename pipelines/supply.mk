# What this project is installed with: under which licences, and whether a weakness is known of it.
.PHONY: licences audit
licences: setup  ## list the licence of every locked package in requirements/licences.md
	@$(BIN)/python -m requirements.licences

# pip-audit is fetched into a folder of its own, so that what is locked stays what is installed. It
# asks the package index for known weaknesses of each version: it needs a network, and fails where a
# version is not known there, so that what was not looked at does not pass.
audit:  ## ask whether a weakness is known of a locked version (needs a network)
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT \
	&& $(PYTHON) -m venv "$$folder" \
	&& "$$folder/bin/python" -m pip -qq --disable-pip-version-check install pip-audit \
	&& "$$folder/bin/pip-audit" --strict --require-hashes --disable-pip --progress-spinner off \
		--requirement requirements/lock.txt
