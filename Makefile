# make            set up .venv, run everything, check          make test       set up, fast tests
# make test-slow  tests that take minutes                      make lint       style, tables, generated documentation
# make record     put today's values on record, show changes   make lock       resolve requirements.lock again
# make bench      measure speed, as ratios                     make gallery    render every log without a screen
# make docs       write the generated documentation            make clean      remove results
# make kernels    run as other machines would, check           make versions   run with older and newer libraries, check
# make nightly    all that is too long for a change

PYTHON ?= python3
BIN := .venv/bin
READY := .venv/ready
RUN := PATH="$(CURDIR)/$(BIN):$$PATH" VIRTUAL_ENV="$(CURDIR)/.venv"

.PHONY: all test test-slow lint lock record bench gallery docs clean kernels kernels-quick versions nightly

all: $(READY)
	@$(RUN) gainsay lint
	@$(RUN) snakemake --cores 2

# uv installs the hashed lock in a sixth of pip's time; pip brings uv itself, by the hash in the same lock.
$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null \
	  || { echo "Gainsay needs Python 3.11, 3.12 or 3.13 as $(PYTHON): install python3, or set PYTHON=/path/to/python3.11"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null \
	  || { echo "Gainsay needs Python's venv: install the package python3-venv"; exit 1; }
	@echo "setting up .venv"
	@rm -rf .venv && $(PYTHON) -m venv .venv
	@sed -n '/^uv==/,/[^\\]$$/p' requirements.lock > .venv/uv.txt
	@$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r .venv/uv.txt
	@$(BIN)/uv pip sync --quiet --require-hashes --compile-bytecode --python $(BIN)/python requirements.lock
	@$(BIN)/uv pip install --quiet --no-deps --no-build-isolation --python $(BIN)/python --editable .
	@$(BIN)/python -m compileall -q workflow/gainsay papers
	@touch $(READY)

test: $(READY)
	@$(RUN) pytest -n 2

test-slow: $(READY)
	@$(RUN) pytest -n 2 -m slow

lint: $(READY)
	@$(RUN) ruff check .
	@$(RUN) ruff format --check .
	@$(RUN) snakefmt --check Snakefile workflow/rules
	@$(RUN) gainsay lint
	@$(RUN) gainsay docs --check

docs: $(READY)
	@$(RUN) gainsay docs

lock: $(READY)
	@$(RUN) uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-header \
	  --group dev pyproject.toml --output-file requirements.lock

record: $(READY)
	@$(RUN) gainsay record

bench: $(READY)
	@$(RUN) python -m gainsay.bench

gallery: $(READY)
	@$(RUN) gainsay gallery

kernels: $(READY)
	@$(RUN) python -m gainsay.steps.kernels

kernels-quick: $(READY)
	@$(RUN) python -m gainsay.steps.kernels --quick

# The same lock with other versions of what solves and integrates: verdicts must be the same, numbers within the record.
OLDER := clarabel==0.10.0 cvxpy==1.7.2 scipy==1.16.2
NEWER := clarabel cvxpy scipy
versions: $(READY)
	@for versions in "$(OLDER)" "--upgrade $(NEWER)"; do \
	  place=$$(mktemp -d) && $(PYTHON) -m venv $$place/venv && \
	  $(BIN)/uv pip sync --quiet --require-hashes --python $$place/venv/bin/python requirements.lock && \
	  $(BIN)/uv pip install --quiet --python $$place/venv/bin/python $$versions && \
	  $(BIN)/uv pip install --quiet --no-deps --no-build-isolation --python $$place/venv/bin/python --editable . && \
	  echo "versions    $$($(BIN)/uv pip list --python $$place/venv/bin/python 2>/dev/null | grep -E '^(clarabel|cvxpy|scipy) ' | tr -s ' \n' ' ')" && \
	  $$place/venv/bin/python -m gainsay.steps.kernels --here; code=$$?; rm -rf $$place; [ $$code = 0 ] || exit $$code; \
	done

nightly: $(READY) kernels versions
	@GAINSAY_CHANGES=5000 $(RUN) pytest -n 2 -m slow tests/known/test_proof_changes.py

clean:
	@rm -rf results/*/ results/index.html results/verdicts.csv results/differences.csv results/.checked
