# Sourced by ./run, ./test and .ci/run: installs what is missing and builds Release in build/release.
# The sourcing script has set -euo pipefail and stands in the repository's root.

say() { printf '\n== %s\n' "$*"; }

# Names of the packages in the given sections of tools/packages.txt.
packages_in() {
  local section="" line name wanted
  while IFS= read -r line; do
    line="${line%%#*}"
    read -r name <<<"$line" || true
    case "$name" in
      "") ;;
      \[*\]) section="$name" ;;
      *) for wanted in "$@"; do [[ "$section" != "[$wanted]" ]] || echo "$name"; done ;;
    esac
  done <tools/packages.txt
}

# Those of the given packages that are not installed.
missing_of() {
  local name
  for name in "$@"; do
    [[ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null || true)" == installed ]] || echo "$name"
  done
}

# install_missing SECTION...: apt only when something is missing; as root, or by sudo where it is there.
install_missing() {
  local -a wanted missing as_root=()
  mapfile -t wanted < <(packages_in "$@")
  if ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian system: install the counterparts of ${wanted[*]} yourself." >&2
    return
  fi
  mapfile -t missing < <(missing_of "${wanted[@]}")
  [[ ${#missing[@]} -gt 0 ]] || return 0
  say "installing ${missing[*]}"
  if [[ $EUID -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
      printf 'These packages are missing and neither root nor sudo is here. As root:\n  apt-get install %s\n' \
        "${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  # Neither a question nor a stale list may stop it.
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

# build_release [TARGET...]: configures once, then builds what changed.
build_release() {
  local -a launcher=()
  [[ -f build/release/build.ninja ]] || {
    command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    say "configuring build/release"
    cmake --preset release "${launcher[@]}"
  }
  say "building build/release"
  cmake --build --preset release -- -j "${JOBS:-$(nproc)}" "$@"
}
