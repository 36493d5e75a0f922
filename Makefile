# Set up the environment and rebuild everything: `make`. What else there is: `make help`.
# Needed on the machine: Python 3.11 or newer with its venv module, make, git.
# Measurements of others, as examples: `make -C examples/frame`, `make -C examples/beam`, `make -C examples/loops`.

PYTHON ?= python3
CORES ?= all
# A configuration that overrides config/config.yaml: make CONFIG=config/measured.yaml
CONFIG ?=
WITH ?=
VENV := .venv
# As in an activated environment: what is started from here finds the same Python.
RUN := PATH="$$HERE/$(VENV)/bin:$$PATH" python -m
# Programs of trials/ use helpers of the tests.
TRIAL := PYTHONPATH="$$HERE/trials:$$HERE/tests" $(RUN)
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
# What `make archive` writes, and what below results/ it leaves out.
ARCHIVE ?= results/archive/dampbalance-$(VERSION).tar.gz
KEPT_APART := archive benchmarks logs site
SNAKEMAKE := $(RUN) dampbalance.project.documents config/config.yaml $${CONFIG:+"$$CONFIG"} && $(RUN) snakemake \
	--workflow-profile workflow/profiles/default $${SNAKEMAKE_OUTPUT_CACHE:+--cache study_chunk} \
	--cores $(CORES) $${CONFIG:+"--configfile=$$CONFIG"}
QUIETLY := install --quiet --disable-pip-version-check --no-compile
PYTEST := $(RUN) pytest --numprocesses auto --dist loadscope --no-loadscope-reorder
PIP_INSTALL := $(RUN) pip $(QUIETLY)
BUILD_LOCK := --require-hashes --requirement requirements-build.lock

# Paths may hold blanks and any other character: recipes take them from the environment, as neither make nor the shell expands
# what stands there. A colon ends a folder of PATH, and what pip installs takes the others for the shell's own.
BARRED := : $$ \ " `
ifneq ($(strip $(foreach mark,$(BARRED),$(findstring $(mark),$(CURDIR)))),)
$(error $(CURDIR): in a folder with one of $(BARRED) in its path no Python environment works: move the project to another one)
endif
override CONFIG := $(value CONFIG)
override WITH := $(value WITH)
override PYTHON := $(value PYTHON)
override ARCHIVE := $(subst $$(VERSION),$(VERSION),$(value ARCHIVE))
export CONFIG WITH PYTHON ARCHIVE
export HERE := $(CURDIR)

# Snakemake and others keep files in the home folder. Where it cannot be written, as in many containers, one here serves.
ifneq ($(shell { cd "$${HOME:?}" && cache="$${XDG_CACHE_HOME:-.cache}" && mkdir -p "$$cache" && test -w "$$cache" && echo yes; } 2>&1),yes)
export HOME := $(CURDIR)/.snakemake/home
export PIP_NO_CACHE_DIR = 1
unexport XDG_CACHE_HOME
$(shell mkdir -p .snakemake/home)
endif

# Three marks: what the rebuild needs is in; the package itself is in; what tests, linters and the site need in addition is in.
# A virtual environment holds absolute paths, so the first mark says where it was made: a copied or moved one is set up again.
LOCKED := $(VENV)/locked
READY := $(VENV)/ready
TOOLS := $(VENV)/tools
LOCKS := requirements-build.lock requirements.lock requirements-dev.lock requirements-engine.lock
BENCH := .venv-bench
ENGINE := .venv-engine
BENCH_RUN := PYTHONPATH="$$HERE/trials:$$HERE/tests" PATH="$$HERE/$(BENCH)/bin:$$PATH" python -m
ifneq ($(shell test -x $(VENV)/bin/python && cat $(LOCKED) 2>/dev/null),$(CURDIR))
STALE := stale
endif

# Nothing of the user's own Python set-up may leak into the environment.
unexport PYTHONPATH PYTHONHOME VIRTUAL_ENV PIP_REQUIRE_VIRTUALENV PIP_USER PIP_TARGET PIP_PREFIX
# Modules are compiled once, when they are first imported: not by every process anew, which takes seconds each.
unexport PYTHONDONTWRITEBYTECODE PYTHONPYCACHEPREFIX
export PYTHONNOUSERSITE = 1

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: all setup test lint unit check night docs archive dist wheels verify compare bench engine processors mutants blind sizes format lock clean distclean help stale

all: $(READY) ## Set up the environment, then rebuild tables, figures and claims (the default)
	@$(SNAKEMAKE)
	@echo "All results are up to date; begin with results/README.md."

setup: $(READY) $(TOOLS) ## Create or refresh the environment in .venv from the hash-pinned locks, with the tools of `make test` and `make docs`

test: lint check unit ## Run what must pass before a merge: lint, types, the rebuild with its claims, the tests of the day

lint: setup ## Check style, formatting and types
	@$(RUN) ruff check .
	@$(RUN) ruff format --check .
	@$(RUN) mypy --num-workers auto
	@$(RUN) snakefmt --check Snakefile workflow examples

unit: setup ## Run the tests of the day (choose with PYTEST_ARGS="-k …")
	@$(PYTEST) -m "not nightly" $(PYTEST_ARGS)

night: setup ## Run the tests of the night: what takes long and rarely breaks, in a browser and a SLURM where these are installed
	@$(PYTEST) -m nightly $(PYTEST_ARGS)

check: $(READY) ## Rebuild what is out of date and compare each verdict with the recorded one
	@$(SNAKEMAKE) check

docs: setup ## Build the site of documentation, with all studies, into results/site/
	@$(SNAKEMAKE) results/site
	@echo "The site is built. Open results/site/index.html."

archive: $(READY) ## Pack the committed sources, all results and their digests into results/archive/
	@test -z "$$(git status --porcelain 2>&1)" || { \
	    echo "error: results belong to committed sources: commit or remove the changes that 'git status' lists." >&2; exit 1; }
	@$(SNAKEMAKE)
	@top=$$(mktemp -d) && trap 'rm -rf "$$top"' EXIT && name="dampbalance-$(VERSION)" \
	    && git archive --prefix="$$name/" HEAD | tar --extract --directory "$$top" \
	    && tar --create $(KEPT_APART:%=--exclude=results/%) results | tar --extract --directory "$$top/$$name" \
	    && (cd "$$top/$$name" && find . -type f ! -name SHA256SUMS -printf '%P\0' | LC_ALL=C sort -z | xargs -0 sha256sum >SHA256SUMS) \
	    && mkdir -p "$$(dirname "$$ARCHIVE")" \
	    && tar --create --format=gnu --sort=name --mtime=@315532800 --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX \
	        --directory "$$top" "$$name" | gzip -9n >"$$top/packed" && mv "$$top/packed" "$$ARCHIVE"
	@echo "The archive is $$ARCHIVE."

dist: $(READY) ## Build the source distribution and the wheel of the package, ready for an index, into dist/
	@rm -rf dist
	@$(RUN) hatchling build
	@echo "To install it elsewhere: pip install \"dist/dampbalance-$(VERSION)-py3-none-any.whl[records]\""

wheels: $(READY) ## Fetch the locked packages for this Python and system, to be kept beside the archive
	@$(RUN) pip download --disable-pip-version-check --no-build-isolation --no-deps --require-hashes \
	    $(foreach lock,$(LOCKS),--requirement $(lock)) --dest results/archive/wheels

# With the packages of `make wheels` it needs no network: PIP_NO_INDEX=1 PIP_FIND_LINKS=$PWD/results/archive/wheels make verify
verify: archive ## Unpack the archive elsewhere, build everything anew there from it alone, and compare (choose with ARCHIVE=…)
	@top=$$(mktemp -d) && trap 'rm -rf "$$top"' EXIT && tar --extract --gzip --directory "$$top" <"$$ARCHIVE" \
	    && cd "$$top"/dampbalance-* \
	    && echo "Rebuilding the archive on its own, in a temporary folder: a few minutes." \
	    && { make --no-print-directory clean all >"$$top/said" 2>&1 || { cat "$$top/said" >&2; exit 1; }; } \
	    && { sha256sum --check --quiet SHA256SUMS >"$$top/different" 2>/dev/null || true; } \
	    && ! grep -v '/manifest.json: FAILED$$' "$$top/different" \
	    && echo "$$(wc -l <SHA256SUMS) files of the archive, and its results rebuilt: the same bytes, except the manifest."

compare: $(READY) ## List what differs between the results here and those of another build (say which: WITH=../other/results)
	@test -n "$$WITH" || { echo "error: Name the other folder: make compare WITH=../other/results" >&2; exit 1; }
	@$(TRIAL) same_results results "$$WITH"

bench: $(BENCH)/ready ## Measure speed and accuracy beside heyoka, diffrax and scipy (choose with BENCH_ARGS="peers")
	@$(BENCH_RUN) benchmarks $(BENCH_ARGS)

engine: $(ENGINE)/ready ## Compile the kernels anew to the WebAssembly with which the page computes
	@PATH="$$HERE/$(ENGINE)/bin:$$PATH" python -m dampbalance.publishing.engine

processors: setup ## Run the tests that compare closely as on processors without AVX-512, and without AVX2 and FMA
	@$(TRIAL) processors --numprocesses auto --dist loadscope $(PYTEST_ARGS)

mutants: setup ## Put errors into the package and see whether its tests notice (choose with MUTANTS_ARGS="motion/flow.py --number 20")
	@$(TRIAL) mutation $(MUTANTS_ARGS)

blind: setup ## Identify records of other make whose truth is known (choose with BLIND_ARGS="efficiency --drawings 50")
	@$(TRIAL) blind $(BLIND_ARGS)

sizes: $(READY) ## Count the lines of code into CONTRIBUTING.md (MEASURE=1: time make, make test and a rebuild, too)
	@$(TRIAL) sizes $(if $(MEASURE),--measure)

format: setup ## Format the sources
	@$(RUN) ruff check --fix .
	@$(RUN) ruff format .
	@$(RUN) snakefmt Snakefile workflow examples

LOCK := uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --fork-strategy fewest \
	--no-header --no-annotate --no-emit-index-url --no-emit-find-links
REBUILD := --extra workflow --extra article
DEVELOP := --extra records --extra slurm --group dev --group docs
# IPython and ipykernel ask for them, and import them only where somebody completes names or steps through code.
UNUSED := debugpy jedi parso

# All together first, so that the locks agree; then what the rebuild needs, and what only tests, linters and the site need.
lock: $(READY) ## Pin the newest versions that pyproject.toml allows, with hashes
	@new=$$(mktemp -d) && trap 'rm -rf "$$new"' EXIT \
	    && $(RUN) $(LOCK) $(REBUILD) $(DEVELOP) --group build --output-file "$$new/all" pyproject.toml \
	    && $(RUN) $(LOCK) $(REBUILD) --constraint "$$new/all" --output-file "$$new/requirements.lock" pyproject.toml \
	        $(UNUSED:%=--no-emit-package %) \
	    && $(RUN) $(LOCK) --group build --constraint "$$new/all" --output-file "$$new/requirements-build.lock" \
	    && $(RUN) $(LOCK) --group engine --output-file "$$new/requirements-engine.lock" \
	    && $(RUN) $(LOCK) $(REBUILD) $(DEVELOP) --constraint "$$new/all" --output-file "$$new/requirements-dev.lock" pyproject.toml \
	        $$(sed -n 's/^\([^ =]*\)==.*/--no-emit-package \1/p' "$$new/requirements.lock") \
	    && cp $(foreach lock,$(LOCKS),"$$new/$(lock)") .

clean: ## Remove results and caches; the environment stays
	find results -mindepth 1 -maxdepth 1 ! -name README.md -exec rm -rf {} +
	find src tests trials examples workflow paper -name __pycache__ -type d -prune -exec rm -rf {} +
	rm -rf .snakemake .mutants .pytest_cache .mypy_cache .ruff_cache .hypothesis build dist

distclean: clean ## Remove the environment as well
	rm -rf $(VENV) $(BENCH) $(ENGINE)

help: ## Show the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

# Each mark is set by the last line of its recipe: an interrupted set-up starts afresh.
$(READY): $(LOCKED) pyproject.toml
	@rm -f $(READY)
	@$(call INSTALL,--editable .)
	@$(RUN) dampbalance.commands.kernels
	@touch $(READY)

$(LOCKED): requirements.lock requirements-build.lock $(STALE)
	@"$$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	    echo "error: Python 3.11 or newer is needed, and $$PYTHON is $$("$$PYTHON" --version 2>&1 || true)."; \
	    echo "       Name another one: make PYTHON=python3.12"; exit 1; } >&2
	@"$$PYTHON" -c 'import ensurepip, venv' 2>/dev/null || { \
	    echo "error: $$PYTHON lacks the venv module."; \
	    echo "       On Debian or Ubuntu install the package python3-venv, then run make again."; exit 1; } >&2
	@echo "Setting up $(VENV): $$(grep -c == requirements.lock) packages from requirements.lock."
	@rm -f $(LOCKED) $(TOOLS)
	@"$$PYTHON" -m venv --clear --without-pip $(VENV)
	@"$$PYTHON" -m pip --python $(VENV)/bin/python $(QUIETLY) $(BUILD_LOCK) 2>/dev/null \
	    || { $(RUN) ensurepip >/dev/null && $(PIP_INSTALL) $(BUILD_LOCK); }
	@$(call INSTALL,--require-hashes --requirement requirements.lock,$(FROM_INDEX))
	@printf '%s' "$$HERE" > $(LOCKED)

$(TOOLS): requirements-dev.lock $(LOCKED)
	@rm -f $(TOOLS)
	@echo "Adding the tools of tests, linters and documentation: $$(grep -c == requirements-dev.lock) packages from requirements-dev.lock."
	@$(call INSTALL,--require-hashes --requirement requirements-dev.lock,$(FROM_INDEX))
	@touch $(TOOLS)

# uv takes a third of pip's time; where it cannot install, pip does.
INSTALL = { $(2) $(RUN) uv pip install --quiet --no-deps --no-build-isolation $(1) \
	|| { echo "uv cannot install $(lastword $(1)) here: pip does."; $(PIP_INSTALL) --no-deps --no-build-isolation $(1); } \
	|| { echo "error: $(lastword $(1)): not installed; pip says above why. If it lacks a compiler or Python.h, install both (on Debian or"; \
	    echo "       Ubuntu gcc and python3-dev), or name a Python for which all packages are compiled: make PYTHON=python3.13"; exit 1; } >&2; }
# It does not read pip's settings: where those name another index they are handed on.
FROM_INDEX = UV_DEFAULT_INDEX="$${UV_DEFAULT_INDEX:-$${PIP_INDEX_URL:-$$($(RUN) pip config get global.index-url 2>/dev/null)}}" \
	UV_NO_INDEX="$${UV_NO_INDEX:-$${PIP_NO_INDEX:-0}}" UV_FIND_LINKS="$${UV_FIND_LINKS:-$$PIP_FIND_LINKS}"

# Peers to measure against and the linker of the engine: environments of their own, which see the packages of the first one.
SITE := import sysconfig; site = sysconfig.get_path("purelib")
ADDED_bench := --group bench
ADDED_engine := --require-hashes --requirement requirements-engine.lock
$(ENGINE)/ready: requirements-engine.lock
$(BENCH)/ready $(ENGINE)/ready: .venv-%/ready: $(READY)
	@echo "Setting up .venv-$*: $(ADDED_$*)"
	@rm -rf .venv-$*
	@$(VENV)/bin/python -m venv --without-pip .venv-$*
	@$(VENV)/bin/python -c '$(SITE); print(f"import site; site.addsitedir({site!r})")' \
	    > "$$(.venv-$*/bin/python -c '$(SITE); print(site)')/locked.pth"
	@$(RUN) pip --python .venv-$*/bin/python install --disable-pip-version-check --no-compile --quiet $(ADDED_$*)
	@touch $@
