# Sourced by ./run, ./test and .ci/run: installs missing packages and builds Release in build/release. The calling script must
# have set -euo pipefail and be in the root of the repository.

say() { printf '\n== %s\n' "$*"; }

# Package names of the given sections of tools/packages.txt.
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

# The given packages that are not installed.
missing_of() {
  local name
  for name in "$@"; do
    [[ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null || true)" == installed ]] || echo "$name"
  done
}

# install_missing SECTION...: calls apt only if a package is missing, as root or with sudo if it exists.
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
  installed=true  # configure() looks for libraries again
  # Neither a question nor an outdated package list may stop the installation.
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

# configure PRESET: configures build/release as the preset product, components or release of CMakePresets.json, each of which
# builds more than the one before. A build folder that builds as much already stays as it is, unless a package was installed.
configure() {
  local preset="$1" cache=build/release/CMakeCache.txt wanted=""
  case "$preset" in
    components) wanted="PALPATE_FIT PALPATE_STUDY PALPATE_LEARNING PALPATE_ROS" ;;
    release) wanted="PALPATE_FIT PALPATE_STUDY PALPATE_LEARNING PALPATE_ROS PALPATE_PYTHON BUILD_TESTING" ;;
  esac
  local option has_all=true
  for option in $wanted; do grep -q "^$option:.*=ON$" "$cache" 2>/dev/null || has_all=false; done
  if [[ ! -f build/release/build.ninja || -n "${installed:-}" ]]; then has_all=false; fi
  if $has_all; then return; fi
  local -a launcher=()
  command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  say "configuring build/release ($preset)"
  cmake --preset "$preset" "${launcher[@]}"
}

# build TARGET...: builds changed targets of build/release.
build() {
  say "building build/release"
  cmake --build build/release -- -j "${JOBS:-$(nproc)}" "$@"
}

# build_release [TARGET...]: configures everything and builds changed targets.
build_release() {
  configure release
  build "$@"
}

# install_playwright: playwright-core in build/page-tools, once (14 MB of the npm registry). It drives a browser that is installed.
install_playwright() {
  [[ -d build/page-tools/node_modules/playwright-core ]] ||
    npm install --prefix build/page-tools --no-save --no-audit --no-fund --loglevel=error playwright-core@1.65.1
}
