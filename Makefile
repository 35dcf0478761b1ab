# make            set up .venv, run everything, check          make test       set up, fast tests
# make test-slow  tests that take minutes                      make lint       style, types, tables, documentation
# make record     put today's values on record, show changes   make lock       resolve requirements.lock again
# make bench      measure speed, as ratios                     make gallery    render every log without a screen
# make docs       write the generated documentation            make clean      remove results
# make kernels    run as other machines would, check           make versions   run with older and newer libraries, check
# make nightly    all that is too long for a change           make look       pages and logs of results, in their viewers
# make slurm      a campaign through Slurm, on this machine    make pictures   those of README, from the results

PYTHON ?= python3
BIN := .venv/bin
RUN := PATH="$(CURDIR)/$(BIN):$$PATH" VIRTUAL_ENV="$(CURDIR)/.venv"

.PHONY: environment all test test-slow look pictures lint lock record bench gallery docs clean kernels kernels-quick versions slurm nightly

all: environment
	@$(RUN) gainsay lint
	@$(RUN) snakemake --cores 2

# Made whole or not at all, under a lock, and anew where the folder was copied or moved.
environment:
	@command -v $(PYTHON) >/dev/null || { echo "Gainsay needs Python 3.11, 3.12 or 3.13: install python3"; exit 2; }
	@$(PYTHON) workflow/environment.py

test: environment
	@$(RUN) pytest -n 2

test-slow: environment
	@$(RUN) pytest -n 2 -m slow

look: environment
	@$(RUN) pytest -n 2 -m slow tests/end_to_end/test_page.py tests/end_to_end/test_foxglove.py

pictures: environment
	@$(RUN) python -m tests.end_to_end.pictures

lint: environment
	@$(RUN) ruff check .
	@$(RUN) ruff format --check .
	@$(RUN) mypy
	@$(RUN) snakefmt --check Snakefile workflow/gainsay/rules
	@$(RUN) gainsay lint
	@$(RUN) gainsay docs --check

docs: environment
	@$(RUN) gainsay docs

lock: environment
	@$(RUN) uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-header \
	  --all-extras --group dev pyproject.toml --output-file requirements.lock
	@$(RUN) uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-header --no-deps \
	  workflow/profiles/slurm/requirements.in --output-file workflow/profiles/slurm/requirements.txt

record: environment
	@$(RUN) gainsay record

bench: environment
	@$(RUN) python -m gainsay.bench

gallery: environment
	@$(RUN) gainsay gallery

kernels: environment
	@$(RUN) python -m gainsay.steps.kernels

kernels-quick: environment
	@$(RUN) python -m gainsay.steps.kernels --quick

# The same lock with other versions of what solves and integrates: verdicts must be the same, numbers within the record.
OLDER := clarabel==0.10.0 cvxpy==1.7.2 scipy==1.16.2
NEWER := clarabel cvxpy scipy
versions: environment
	@worst=0; for versions in "$(OLDER)" "--upgrade $(NEWER)"; do \
	  place=$$(mktemp -d) && $(PYTHON) -m venv $$place/venv && \
	  $(BIN)/uv pip sync --quiet --require-hashes --python $$place/venv/bin/python requirements.lock && \
	  $(BIN)/uv pip install --quiet --python $$place/venv/bin/python $$versions && \
	  $(BIN)/uv pip install --quiet --no-deps --no-build-isolation --python $$place/venv/bin/python --editable . && \
	  echo "versions    $$($(BIN)/uv pip list --python $$place/venv/bin/python 2>/dev/null | grep -E '^(clarabel|cvxpy|scipy) ' | tr -s ' \n' ' ')" && \
	  $$place/venv/bin/python -m gainsay.steps.kernels --here; code=$$?; rm -rf $$place; \
	  [ $$code -le $$worst ] || worst=$$code; \
	done; exit $$worst

# A campaign through Slurm on this machine, in so many seconds; without Slurm: skipped, not checked.
SLURM_SECONDS ?= 1170
slurm: environment
	@GAINSAY_SLURM=$(SLURM_SECONDS) $(RUN) pytest -n 0 -m slow -rs tests/end_to_end/test_slurm.py

nightly: environment kernels versions
	@GAINSAY_NIGHT=1 $(RUN) pytest -n 2 -m slow tests/known/test_proof_changes.py tests/gainsay/test_tables_damage.py \
	  tests/gainsay/test_results_damage.py tests/gainsay/test_crate.py tests/papers/test_assumed_inputs.py \
	  tests/papers/test_own_choices.py

clean:
	@rm -rf results/*/ results/.checked results/*.html results/*.json results/*.csv results/*.log
