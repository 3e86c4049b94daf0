# `make evals`, `make test` and `make lint` set everything up by themselves on a machine with Python 3.11 or newer.
PRESET ?= laptop
SEEDS ?= 1
PYTHON ?= $(firstword $(foreach p,python3 python3.14 python3.13 python3.12 python3.11,$(shell $(p) -c 'import sys; sys.version_info >= (3, 11) and print("$(p)")' 2>/dev/null)))
BIN := .venv/bin
# Runs, sequences and reports go into the checkout; make evals GARMENTBENCH_HOME=/elsewhere moves them.
export GARMENTBENCH_HOME := $(CURDIR)
RUN := $(BIN)/garmentbench

.PHONY: evals evals-full bench test lint report data validation fabrics difficulty convergence crosscheck clean
evals: $(BIN)/.installed
	$(RUN) evals --preset $(PRESET) --seeds $(SEEDS)

test: $(BIN)/.installed-test
	$(BIN)/python -m pytest

# Format, lint, types, and that no lower floor imports a higher one: what .ci/run asks before the tests.
lint: $(BIN)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/basedpyright
	$(BIN)/lint-imports

report: $(BIN)/.installed
	$(RUN) report --preset $(PRESET)

data: $(BIN)/.installed
	$(RUN) evals --preset $(PRESET) --data-only

# Trust in the reference; none is part of `make evals`, whose report shows them once they are there.
# The simulator on problems with known answers (a minute), and the named fabrics in a laboratory's tests (some minutes).
validation: $(BIN)/.installed
	$(RUN) evals validation --preset $(PRESET)

fabrics: $(BIN)/.installed
	$(RUN) evals fabrics --preset $(PRESET)

# What each scene asks for: pose alone, dynamics, or more than can be foretold (tens of minutes).
difficulty: $(BIN)/.installed
	$(RUN) evals difficulty --preset $(PRESET)

# The whole of what `make evals` has a short form of, on every headline scene (hours): error against run time; each part
# built and left out, with trainings both ways.
evals-full: $(BIN)/.installed
	$(RUN) evals error-time-whole --preset $(PRESET) --seeds $(SEEDS)
	$(RUN) evals stability-whole --preset $(PRESET)
	$(RUN) evals left-out-whole --preset $(PRESET) --seeds $(SEEDS)

convergence: $(BIN)/.installed
	$(RUN) evals convergence --preset $(PRESET)

crosscheck: $(BIN)/.installed
	$(BIN)/pip install -q -c constraints.txt -e '.[crosscheck]'
	$(RUN) evals crosscheck --preset $(PRESET)

# What a frame takes on this machine, of the simulator and of methods (five minutes).
bench: $(BIN)/.installed
	$(RUN) bench --preset $(PRESET)

# One ablation and the full model beside it: make ablation-fixed-weights, -no-virtual-sample, -no-velocity, -no-force,
# -pose-only, -no-collision, -push-out, -linear-paths, -train-length; -tuned has no full model beside it, but its own.
ablation-%: $(BIN)/.installed
	$(RUN) evals ablation-$* --preset $(PRESET) --seeds $(SEEDS)

$(BIN)/.installed: pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "garmentbench needs Python 3.11 or newer; none found (set PYTHON=/path/to/python3.11)"; exit 2; }
	$(PYTHON) -m venv .venv
	$(BIN)/pip install -q -c constraints.txt -e .
	touch $@

$(BIN)/.installed-test: $(BIN)/.installed
	$(BIN)/pip install -q -c constraints.txt -e '.[test]'
	touch $@

$(BIN)/.installed-dev: $(BIN)/.installed
	$(BIN)/pip install -q -c constraints.txt -e '.[dev]'
	touch $@ $(BIN)/.installed-test

clean:
	rm -rf runs sequences
