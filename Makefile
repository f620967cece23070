# make demo   plan the built-in scene `vertical` into demo/ and print its certificate
# make test   everything that must hold: lint, types, import layers, C++ tests under sanitizers, docs, pytest
# make docs   build the documentation into site/
# make bench  plan all scenes, replay them independently, write benchmarks/results/
# make speed  measure the speed against the paper's method, write benchmarks/results/speed.md and docs/images
# make clean  remove everything that was made, the virtual environment included
#
# Choose another interpreter with `make PYTHON=python3.12 ...`.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
BUILD_INPUTS := pyproject.toml CMakeLists.txt $(shell find cpp -name '*.?pp')

# An environment that was interrupted, or whose Python is gone, is made anew.
ifneq ($(shell $(BIN)/python -c 'import pip; print("usable")' 2>/dev/null),usable)
$(shell rm -f $(VENV)/.made $(VENV)/.installed-*)
endif

.PHONY: demo test docs bench speed clean
.DEFAULT_GOAL := demo

$(VENV)/.made:
	@scripts/prepare_venv.sh '$(PYTHON)' $(VENV)
	@touch $@

$(VENV)/.installed-plot: $(VENV)/.made $(BUILD_INPUTS)
	@echo "installing tightspot and building its C++ core"
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --editable '.[plot]'
	@touch $@

$(VENV)/.installed-dev: $(VENV)/.made $(BUILD_INPUTS)
	@echo "installing tightspot, building its C++ core, installing what its tests need"
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $(VENV)/.installed-plot $@

demo: $(VENV)/.installed-plot
	@$(BIN)/tightspot plan vertical --output demo
	@echo "Look at the picture: demo/plan.png"

# pytest comes last: its closing line is the result.
test: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	PATH="$(CURDIR)/$(BIN):$$PATH" cpp/run_tests.sh
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	$(BIN)/pytest -n 2

docs: $(VENV)/.installed-dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo "Open site/index.html"

bench: $(VENV)/.installed-dev
	$(BIN)/python -m benchmarks.plan_scenes

speed: $(VENV)/.installed-dev
	$(BIN)/python -m benchmarks.speed

clean:
	rm -rf $(VENV) build demo site benchmarks/__pycache__ .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
