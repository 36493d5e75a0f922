# What `make` does for each example: it runs in the folder and the environment of the project, with its readers of records.
# Records elsewhere: make -C examples/frame DATA=/a/folder
NAME := $(notdir $(CURDIR))
export DATA

all:
	@test -e ../../.venv/tools || $(MAKE) -C ../.. setup
	@cd ../.. && PATH="$$PWD/.venv/bin:$$PATH" python -m snakemake --snakefile examples/$(NAME)/Snakefile --cores 1 --config data="$$DATA"

.PHONY: all
