# What people do with a checkout; everything it needs is set up on the way. `make help` lists the targets.

MODEL ?= assets/demo.glb
PICTURE ?= demo.png
ARGS ?=
# The picture of README.md, at the price of half a minute on two cores. QUALITY= takes a second or two, LOOK= looks at a
# model of your own as `render` does.
LOOK ?= --orbit 20,8 --fov 25 --light=-70,30,5 --env-intensity 0.5 --exposure 0.3
QUALITY ?= --quality high

READY := .venv/.ready
READY_TESTS := .venv/.ready-tests
BIN := .venv/bin

.PHONY: help demo view test lint docs bench clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "make %-6s %s\n", $$1, $$2}' Makefile

demo: $(READY) ## render MODEL (assets/demo.glb) to PICTURE (demo.png); QUALITY= does it fast
	@echo "rendering; without a graphics card this takes half a minute or more"
	@$(BIN)/pbr-viewer render "$(MODEL)" -o "$(PICTURE)" $(LOOK) $(QUALITY) $(ARGS)
	@echo "the picture: $(abspath $(PICTURE))"

view: $(READY) ## look at MODEL in a window
	@$(BIN)/pbr-viewer view "$(MODEL)" $(ARGS)

test: lint $(READY_TESTS) ## check the code, then run the tests; ARGS="-k egl" goes to pytest
	@$(BIN)/python -m pytest -n auto --maxprocesses 8 --dist loadfile $(ARGS)

lint: $(READY) ## check the code without running it: ruff, mypy
	@$(BIN)/ruff check .
	@$(BIN)/mypy

docs: $(READY) ## build the site of the documentation into build/site
	@$(BIN)/python -m pip install -q --disable-pip-version-check -e '.[docs]'
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build -q
	@echo "the site: $(abspath build/site/index.html)"

bench: $(READY) ## measure speed and memory; ARGS goes to benchmarks
	@$(BIN)/python -m benchmarks $(ARGS)

clean: ## remove what make has made
	rm -rf .venv .pytest_cache .ruff_cache .mypy_cache golden-failures build dist demo.png
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Made anew when what the package depends on has changed.
$(READY): pyproject.toml .ci/setup.sh
	@.ci/setup.sh

# Once; what cannot be installed costs the tests that need it.
$(READY_TESTS): $(READY)
	@.ci/setup.sh tests
