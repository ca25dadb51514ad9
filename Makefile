# Every target sets up what it needs: a virtual environment in .venv and the package in it.

# Compiled modules are kept, also where containers are set up not to: some forty tests start other processes.
unexport PYTHONDONTWRITEBYTECODE

PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
SPHINX := $(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet --doctree-dir out/doctrees

.PHONY: help setup opengl browser demo docs studio teapot test test-all mutants lint examples reproduce bench reference wheels clean

help:
	@echo "make demo      blend three pipes: proof, mesh and picture, in out/"
	@echo "make docs      the documentation, in out/docs"
	@echo "make studio    the studio in the browser: drag, see, prove"
	@echo "make teapot    the teapot: proofs, meshes and pictures, in out/teapot/"
	@echo "make test      the tests that CI runs"
	@echo "make test-all  these with newly drawn cases, and the slow ones"
	@echo "make mutants   break each rule of the proofs and see a test fail"
	@echo "make lint      style, types, and all pages of the documentation read without a warning"
	@echo "make examples  all examples with their pictures"
	@echo "make reproduce everything that five published works print, recomputed"
	@echo "make bench     benchmarks beside other programs; a page of them in out/"
	@echo "make reference sixty cases beside the values that were kept"
	@echo "make wheels    wheels for Linux, macOS and Windows, in dist/"

setup: $(VENV)/.ready opengl

$(VENV)/.ready: pyproject.toml setup.py build_backend.py $(wildcard pas/kernels/*.c pas/kernels/*.h)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[develop]'
	touch $@

# Pictures need the system's OpenGL; root installs it, others are told how.
opengl:
	@$(PYTHON) -c "import ctypes; [ctypes.CDLL(n) for n in ('libGL.so.1', 'libEGL.so.1', 'libXrender.so.1')]" 2>/dev/null || \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		echo "installing OpenGL for pictures (libgl1 libegl1 libxrender1)"; \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libgl1 libegl1 libxrender1 >/dev/null; \
	else \
		echo "pictures need OpenGL: apt-get install libgl1 libegl1 libxrender1"; \
	fi

# The studio's tests need a browser; root installs it, others may have one, and the tests say so where there is none.
# After OpenGL, as the system installs one thing at a time.
browser: opengl
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
		echo "installing a browser for the tests of the studio (chromium)"; \
		apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium >/dev/null; \
	else \
		echo "the tests of the studio need a browser: apt-get install chromium"; \
	fi

demo: setup
	$(BIN)/pas blend examples/corners/three_pipes.toml -o out

docs: setup
	$(SPHINX) --builder html docs out/docs
	@echo "open out/docs/index.html"

studio: setup
	$(BIN)/pas studio

teapot: setup
	$(BIN)/python examples/teapot/teapot.py -o out/teapot

# Tests are run on all processors already, where threads of BLAS would only wait for one another.
test test-all: export OPENBLAS_NUM_THREADS = 1

test: setup browser
	$(BIN)/python -m pytest -n auto --dist worksteal

test-all: setup browser
	$(BIN)/python -m pytest -n auto --dist worksteal -m "slow or not slow"

mutants: setup
	$(BIN)/python tests/mutants/run.py

lint: setup
	$(BIN)/ruff check pas tests examples benchmarks docs
	$(BIN)/ruff format --check pas tests examples benchmarks docs
	$(BIN)/mypy
	$(SPHINX) --builder dummy docs out/docs

examples: setup
	$(BIN)/python examples/corners/corners.py
	$(BIN)/python examples/parametric/parametric.py
	$(BIN)/python examples/parametric/generatrix/generatrix.py
	for script in examples/gallery/*.py; do $(BIN)/python $$script || exit 1; done

reproduce: setup
	$(BIN)/python docs/reproduction/reproduce.py

bench: setup
	mkdir -p out
	$(BIN)/python -m pytest benchmarks --benchmark-json=out/benchmarks.json
	$(BIN)/python benchmarks/page.py out/benchmarks.json > out/benchmarks.md

reference: setup
	$(BIN)/python benchmarks/reference.py --against benchmarks/reference.json

wheels: setup
	$(BIN)/python -m pip install --quiet --disable-pip-version-check ziglang
	$(BIN)/python build_wheels.py

clean:
	rm -rf $(VENV) out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache
