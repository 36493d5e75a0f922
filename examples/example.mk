# What `make` does for each example: it runs in the folder and the environment of the project.
# Records elsewhere: make -C examples/frame DATA=/a/folder
NAME := $(notdir $(CURDIR))
export DATA

all:
	@test -e ../../.venv/ready || $(MAKE) -C ../.. .venv/ready
	@cd ../.. && PATH="$$PWD/.venv/bin:$$PATH" python -m snakemake --snakefile examples/$(NAME)/Snakefile --cores 1 --config data="$$DATA"

.PHONY: all
