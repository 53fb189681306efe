#!/bin/sh
# Makes .venv with the package in it, and sees to it that OpenGL works; `make` calls it when it has to.
# It may be interrupted and run again at any point: what is half made is made anew.
#
#   .ci/setup.sh             what rendering needs
#   .ci/setup.sh tests       what the tests need besides, where it may install it; without it, tests are skipped
#   PYTHON=/path/to/python   the Python to use instead of the first that is new enough
set -eu
cd "$(dirname "$0")/.."

VENV=.venv

say() { printf '%s\n' "$*" >&2; }
fail() { say "setup: $*"; exit 1; }

# as_root COMMAND...: with the rights to install packages, or not at all; never asks for a password.
as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"
    elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then sudo -n "$@"
    else return 1
    fi
}

APT="DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends"
apt_update() { as_root apt-get update -qq >/dev/null || true; }

is_new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; }

find_python() {
    for python in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11 python}; do
        if is_new_enough "$python"; then echo "$python"; return; fi
    done
    fail "Python 3.11 or newer is needed, and ${PYTHON:-python3} is not: install it, or set PYTHON=/path/to/python3"
}

venv_works() { is_new_enough $VENV/bin/python && $VENV/bin/python -m pip --version >/dev/null 2>&1; }

# Debian and Ubuntu keep the module that makes environments in a package of its own.
make_venv() {
    rm -rf $VENV
    "$1" -m venv $VENV >/dev/null 2>&1 && venv_works && return
    version=$("$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    if command -v apt-get >/dev/null && as_root true; then
        say "installing python$version-venv"
        apt_update
        as_root env $APT "python$version-venv" >/dev/null || as_root env $APT python3-venv >/dev/null || true
        rm -rf $VENV
        "$1" -m venv $VENV >/dev/null 2>&1 && venv_works && return
    fi
    rm -rf $VENV
    "$1" -m virtualenv -q $VENV >/dev/null 2>&1 && venv_works && return
    rm -rf $VENV
    # A pip of the system's may not install into the system, but may into a folder.
    if "$1" -m pip install -q --target $VENV.virtualenv virtualenv >/dev/null 2>&1; then
        PYTHONPATH=$VENV.virtualenv "$1" -m virtualenv -q $VENV >/dev/null 2>&1 || true
    fi
    rm -rf $VENV.virtualenv
    venv_works && return
    rm -rf $VENV
    fail "$1 cannot make a virtual environment: install python$version-venv (Debian, Ubuntu: sudo apt-get install python$version-venv)"
}

opengl_works() {
    $VENV/bin/python -c 'import sys; from viewer.jobs.doctor import diagnose, exit_status; sys.exit(exit_status(diagnose()))'
}

# The command that installs Mesa's software OpenGL on this system, or nothing where it is unknown.
mesa_command() {
    if command -v apt-get >/dev/null; then echo "apt-get install -y libegl1 libgl1 libgl1-mesa-dri"
    elif command -v dnf >/dev/null; then echo "dnf install -y mesa-libEGL mesa-libGL mesa-dri-drivers"
    elif command -v pacman >/dev/null; then echo "pacman -Sy --noconfirm --needed mesa"
    elif command -v zypper >/dev/null; then echo "zypper -n install Mesa-libEGL1 Mesa-libGL1 Mesa-dri"
    elif command -v apk >/dev/null; then echo "apk add mesa-egl mesa-gl mesa-dri-gallium"
    fi
}

install_mesa() {
    command=$(mesa_command)
    [ -n "$command" ] || fail "no OpenGL 3.3 driver works here: install one, or Mesa's software one"
    as_root true || fail "no OpenGL driver works here; install Mesa's software one: sudo $command"
    say "no OpenGL driver works here: $command"
    if command -v apt-get >/dev/null; then
        apt_update
    fi
    as_root env DEBIAN_FRONTEND=noninteractive $command >/dev/null || fail "this failed: $command"
}

is_any_here() {
    for program in "$@"; do
        if command -v "$program" >/dev/null; then return 0; fi
    done
    return 1
}

osmesa_works() {
    $VENV/bin/python -c 'from viewer.gpu.context import create_context; create_context("osmesa").release()' \
        >/dev/null 2>&1
}

# The packages, by their names in Debian, that the tests need and this system lacks.
missing_for_tests() {
    is_any_here Xvfb || echo xvfb
    is_any_here xdotool || echo xdotool
    is_any_here chromium chromium-browser google-chrome chrome || echo chromium
    is_any_here glslangValidator || echo glslang-tools
    ls /usr/share/vulkan/icd.d/lvp_icd*.json >/dev/null 2>&1 || echo mesa-vulkan-drivers
    osmesa_works || echo libosmesa6
}

EXTRAS="docs batch oidn formats cad usd film vdb notebook serve"
install_extras() { $VENV/bin/python -m pip install -q --disable-pip-version-check -e ".[$1]" >/dev/null 2>&1; }

# Nothing here fails: what cannot be had is said at the end of the tests.
install_for_tests() {
    # Together, since pip builds the package anew each time; one at a time where a machine does not have all of them.
    if ! install_extras "$(echo $EXTRAS | tr ' ' ,)"; then
        for extra in $EXTRAS; do install_extras "$extra" || true; done
    fi
    missing=$(missing_for_tests)
    [ -n "$missing" ] || return 0
    if command -v apt-get >/dev/null && as_root true; then
        say "installing what the tests need:" $missing
        apt_update
        for package in $missing; do  # one at a time: newer releases of Debian have no libosmesa6
            as_root env $APT "$package" >/dev/null 2>&1 || true
        done
        missing=$(missing_for_tests)
    fi
    [ -z "$missing" ] || say "some tests will be skipped for want of (by Debian's names):" $missing
}

if [ "${1:-}" = tests ]; then
    install_for_tests
    touch $VENV/.ready-tests
    exit
fi

if ! venv_works; then
    python=$(find_python)
    make_venv "$python"
fi

say "installing pbr-viewer into $VENV (the first time takes a minute)"
$VENV/bin/python -m pip install -q --disable-pip-version-check -e '.[test]' ||
    fail "pip could not install the package; see its message above"

if ! opengl_works; then
    install_mesa
    if ! opengl_works; then
        $VENV/bin/pbr-viewer doctor >&2 || true
        fail "no OpenGL driver works here"
    fi
fi

touch $VENV/.ready
