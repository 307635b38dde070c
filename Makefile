# `make run` does the main job, `make test` runs every check, `make test-kernels` the numerical tests again with
# another BLAS kernel, `make smoke` only trains every experiment for a few steps, `make docs` builds the site in
# build/site; each sets up .venv first, once.

VENV := .venv
READY := $(VENV)/.ready
BIN := $(VENV)/bin

# The commands that the tests start read the compiled modules that the first of them leaves.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run test types tests test-kernels smoke docs setup clean
.DELETE_ON_ERROR:

run: $(READY)
	$(BIN)/swamp-rl run configs/experiments/camogli.yaml

test: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(MAKE) --jobs 2 types tests

# Laid out as installed; a second check looks at what changed.
types: $(READY)
	rm -rf build/types && mkdir -p build/types/swamp_rl
	ln -s $(CURDIR)/swamp_rl/* $(CURDIR)/envs $(CURDIR)/experiments build/types/swamp_rl/
	ln -s $(CURDIR)/swamp_rl_command.py build/types/
	cd build/types && $(CURDIR)/$(BIN)/mypy --config-file $(CURDIR)/pyproject.toml \
	  --cache-dir $(CURDIR)/.mypy_cache

tests: $(READY)
	$(BIN)/python -m pytest -n 3 --dist loadgroup # for two cores: one waits where two compute

# A kernel that OpenBLAS does not choose by itself on this processor, for sums that end in other last bits.
KERNEL := $(shell grep -qs avx512f /proc/cpuinfo && echo Haswell || echo Prescott)

test-kernels: $(READY)
	OPENBLAS_CORETYPE=$(KERNEL) $(BIN)/python -m pytest -n 2 --dist loadgroup -m numerical

smoke: $(READY)
	$(BIN)/python -m pytest -n 2 tests/experiments/studies/test_smoke.py

docs: $(READY)
	$(BIN)/python -m sphinx -E -W --keep-going -q docs build/site
	@echo "the site is in build/site/index.html"

setup: $(READY)

# Only a finished set-up leaves the stamp, so an interrupted one is taken up again.
$(READY): requirements.txt pyproject.toml
	@python=; for name in python3.11 python3 python; do \
	  if $$name -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then python=$$name; break; fi; \
	done; \
	if [ -z "$$python" ]; then echo "make: Python 3.11 or newer is needed; install it and try again" >&2; exit 1; fi; \
	$$python -m venv $(VENV)
	$(BIN)/python -m pip install --disable-pip-version-check -r requirements.txt
	$(BIN)/python -m pip install --disable-pip-version-check --no-build-isolation --no-deps -e .
	touch $@

clean:
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis
