# Makes .venv in the project's root and installs the package there, only where something has changed.
# Sourced by scripts/demo and scripts/test; sets `root`, and `prepare [EXTRA]` does the work.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv="$root/.venv"

fail() { echo "error: $*" >&2; exit 2; }

is_new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }

find_python() {
    local candidate
    for candidate in ${PYTHON:+"$PYTHON"} python3.11 python3 python3.12 python3.13 python; do
        if command -v "$candidate" >/dev/null && is_new_enough "$candidate"; then
            command -v "$candidate"
            return
        fi
    done
    fail "Python 3.11 or newer is needed; found $(python3 --version 2>&1 || true). Set PYTHON to one."
}

# Without Debian's python3-venv a new environment has no pip of its own: the outer pip then serves it.
make_venv() {
    local python=$1
    rm -rf "$venv"
    "$python" -m venv "$venv" >/dev/null 2>&1 \
        || { rm -rf "$venv"; "$python" -m venv --without-pip "$venv"; } \
        || fail "cannot make $venv with $python"
}

pip_install() {
    local python=$1
    shift
    if "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
        "$venv/bin/python" -m pip install --quiet --disable-pip-version-check "$@"
    else
        "$python" -m pip --python "$venv/bin/python" install --quiet \
            --disable-pip-version-check "$@"
    fi
}

# What the installation depends on: the project file, where it stands, the Python, the extra.
stamp_of() {
    { cat "$root/pyproject.toml"; "$venv/bin/python" --version; echo "$root $1"; } | sha256sum
}

prepare() {
    local extra=${1:-} python bytecode target="$root" stamp="$venv/.installed${1:+-$1}"
    if ! is_new_enough "$venv/bin/python"; then
        python=$(find_python)
        echo "making $venv with $("$python" --version)" >&2
        make_venv "$python"
    fi
    [ "$(stamp_of "$extra")" = "$(cat "$stamp" 2>/dev/null || true)" ] && return
    [ -n "$extra" ] && target="$root[$extra]"
    echo "installing into $venv; the first time this also compiles the kernels, in $(nproc 2>/dev/null || echo all) processes (some minutes)" >&2
    # tests have Python compile what they import: to compile all of 1 GB of libraries takes pip 20 s more
    [ "$extra" = test ] && bytecode=--no-compile
    pip_install "${python:-$(find_python)}" ${bytecode:-} --editable "$target" \
        || fail "the installation failed; the lines above say why"
    stamp_of "$extra" >"$stamp"
}
