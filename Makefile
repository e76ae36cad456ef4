# One command for each thing people do here. `make` alone lists them.

SHELL := /bin/bash
VENV := .venv
RUN := $(VENV)/bin/python
READY := $(VENV)/.ready
PYTEST := $(RUN) -m pytest -n 2 --dist loadfile
# These keep both processors busy by themselves, and judge what happens in how many seconds.
ALONE := tests/grading/test_samples.py tests/grading/test_samples_hostile.py tests/ros
SAMPLES := build/class
SUBMISSIONS ?= $(SAMPLES)
OUT ?= grades
BENCHES = $(sort $(wildcard tests/bench/bench_*.py))

.DEFAULT_GOAL := help
.PHONY: help lab test lint test-opencv4 test-samples bench site grade notebooks release flight images system lock clean

help: ## list these targets
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "  make %-14s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))

lab: $(READY) ## open the course in JupyterLab (sets everything up the first time)
	@.ci/lab

test: $(READY) lint ## pass the tests (sets everything up the first time)
	$(PYTEST) --nbval --nbval-sanitize-with tests/notebooks/sanitize.cfg \
	  $(addprefix --ignore=,$(ALONE)) tests notebooks solutions
	$(RUN) -m pytest $(ALONE)

lint: $(READY)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy

test-opencv4: .venv-opencv4/.ready ## pass the library's tests on OpenCV 4 too
	.venv-opencv4/bin/python -m pytest -n 2 --dist loadfile tests/unit

test-samples: $(READY) ## grade every sample submission under both sandboxes (half an hour)
	COURSE_ALL_SAMPLES=1 $(RUN) -m pytest tests/grading/test_samples.py tests/grading/test_samples_hostile.py

bench: $(READY) ## measure sliders, the locator, the notebooks and the grader against what one would otherwise use
	@set -e; for bench in $(BENCHES); do echo "== $$bench"; $(RUN) $$bench; done

site: $(READY) ## export the course as web pages whose sliders need no kernel, into site/
	$(RUN) -m course_lib.publish.site --out site

grade: $(READY) ## grade SUBMISSIONS=folder (a sample class of 20) and write the results to OUT=folder (grades)
ifeq ($(SUBMISSIONS),$(SAMPLES))
	$(RUN) tests/grading/samples/make_class.py $(SAMPLES)
endif
	$(VENV)/bin/course grade $(SUBMISSIONS) --out $(OUT)

notebooks: $(READY) ## execute the notebooks and store their outputs, as CI expects them
	$(RUN) -m course_lib.publish.execute notebooks solutions

release: $(READY) ## make exercises/ from solutions/, and build/students.zip
	@mkdir -p build
	$(RUN) -m course_lib.grading.release --bundle build/students.zip

flight: $(READY) ## write the recorded flight for `rosbag play`, into build/flight_raw.bag
	$(RUN) -m course_lib.real_ros.raw build/flight_raw.bag

images: .venv-render/.ready ## render every picture and flight again (Python 3.11; hours on two cores)
	.venv-render/bin/python images/render/render_all.py

system: ## install the Debian packages for the browser, sandbox and ROS tests
	@.ci/system

lock: $(READY) ## pin every dependency again, after a change of pyproject.toml
	@.ci/lock

clean: ## remove the environments and everything that was built
	rm -rf .venv .venv-opencv4 .venv-render site build .mypy_cache .pytest_cache .ruff_cache

# An environment is ready when its stamp exists. A system upgrade can take its Python away: then
# the stamp lies and goes.
$(shell [ -e $(READY) ] && ! $(RUN) -c '' 2>/dev/null && rm -f $(READY))

$(READY): requirements.lock pyproject.toml
	@.ci/environment $(VENV) requirements.lock

.venv-opencv4/.ready: tests/requirements-opencv4.lock pyproject.toml
	@.ci/environment .venv-opencv4 tests/requirements-opencv4.lock

.venv-render/.ready: images/render/requirements.lock
	@.ci/environment .venv-render images/render/requirements.lock
