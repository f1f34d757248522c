# What the commands in this folder share. Sourced, never run.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=$root/build/release/bin
cache=${XDG_CACHE_HOME:-$HOME/.cache}/forcebound
gate_passed=$cache/gate-passed  # the commit that passed the gate (.ci/run) last

# A clone in another place finds what this one has compiled, with precompiled headers too, whose times clang looks at.
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime

# As many tests at a time as the processors hold, of which each takes some tenths (deploy/cmake/ForceboundTest.cmake).
test_tenths=$((10 * $(nproc)))

say() { printf '%s\n' "$*"; }

# fail [STATUS] TEXT: one line on stderr, then the end. Status 2 means wrong use.
fail() {
  local status=1
  if [[ $1 =~ ^[0-9]+$ ]]; then status=$1; shift; fi
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit "$status"
}

# The comment at the head of the calling script is its help.
show_help() { sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"; }

# logged NAME COMMAND...: runs it silently; shows the end of what it said only if it failed.
logged() {
  local log=$root/build/log/$1.log; shift
  mkdir -p "${log%/*}"
  if "$@" >"$log" 2>&1 </dev/null; then return; fi
  tail -n 40 "$log" >&2
  fail "failed: $* (all of it: ${log#"$root"/})"
}

# As many compilers as there are processors, but no more than memory holds: some sources take most of a GB.
jobs_that_fit() {
  local jobs kB
  jobs=$(nproc)
  kB=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo 2>/dev/null) || true
  if [[ -n $kB ]] && ((kB / 1000000 < jobs)); then
    jobs=$((kB / 1000000 > 1 ? kB / 1000000 : 1))
    say "Little memory ($((kB / 1000)) MB): $jobs compiler(s) at a time" >&2
  fi
  printf '%s' "$jobs"
}

# build_programs TARGET...: installs what is missing, then the release build of programs, without what only tests need.
# Where the tests have been built they stay.
build_programs() {
  local without_tests=()
  "$root/deploy/setup"
  [[ -f $root/build/release/CMakeCache.txt ]] || without_tests=(-DBUILD_TESTING=OFF)
  build release "${without_tests[@]}" "$@"
}

# build_with_tests TARGET...: the same of what lies among the tests, benchmarks and stand-ins too, with what these need.
build_with_tests() {
  "$root/deploy/setup" --tests
  build release -DBUILD_TESTING=ON "$@"
}

# On a terminal ninja's own line shows how far it is; a log gets a line for every tenth part.
show_tenths() {
  local line shown=0
  while IFS= read -r line; do
    if [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] && ((10 * BASH_REMATCH[1] / BASH_REMATCH[2] > shown)); then
      shown=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
      say "  ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}"
    fi
  done
}

# build PRESET [-D...] [TARGET...]: configures if need be and builds the targets, or everything.
build() {
  local preset=$1 start=$SECONDS jobs definitions=(); shift
  local log=$root/build/log/build-$preset.log
  while [[ ${1:-} == -D* ]]; do definitions+=("$1"); shift; done
  jobs=$(jobs_that_fit)
  cd "$root"
  logged "configure-$preset" cmake --preset "$preset" "${definitions[@]}"
  # Of a folder that another compiler has built CMake keeps nothing, not even what the preset says.
  if grep -q 'require your cache to be deleted' "$root/build/log/configure-$preset.log"; then
    logged "configure-$preset" cmake --fresh --preset "$preset" "${definitions[@]}"
  fi
  local command=(cmake --build --preset "$preset" -j "$jobs")
  if (($#)); then command+=(--target "$@"); fi
  if [[ -t 1 ]]; then
    "${command[@]}" || fail "the $preset build failed, see above"
  else
    say "Building $preset with $jobs jobs"
    if ! "${command[@]}" 2>&1 | tee "$log" | show_tenths; then
      grep -E -m 3 -A 30 '^FAILED:|error:' "$log" >&2 || tail -n 40 "$log" >&2
      fail "the $preset build failed (all of it: ${log#"$root"/})"
    fi
  fi
  say "Built $preset in $((SECONDS - start)) s"
}

# Of this Debian, such as bookworm.
debian_suite() { sed -n 's/^VERSION_CODENAME=//p' /etc/os-release; }

# bare_debian SUITE FOLDER: a Debian of debootstrap, with nothing but what every one has. Packages come from where this
# machine's come from, if it is of that suite.
bare_debian() {
  local suite=$1 folder=$2 start=$SECONDS
  mkdir -p "$folder"
  # Its services have users of their own, who are to see what is in it.
  chmod 755 "$folder"
  logged debootstrap debootstrap --variant=minbase "$suite" "$folder"
  cp -r /etc/apt/apt.conf.d "$folder/etc/apt/"
  if [[ $suite == "$(debian_suite)" ]]; then cp -r /etc/apt/sources.list* "$folder/etc/apt/" 2>/dev/null || true; fi
  cp /etc/resolv.conf "$folder/etc/resolv.conf"
  # And npm's registry, where that takes an authority of its own.
  local authorities=
  authorities=$(npm config get cafile 2>/dev/null) || true
  if [[ -f $authorities ]]; then
    cp "$authorities" "$folder/etc/npm-authorities.crt"
    say "cafile=/etc/npm-authorities.crt" >"$folder/etc/npmrc"
  fi
  say "A bare Debian ($suite) in $((SECONDS - start)) s"
}

# Before a client: without the rights to real-time scheduling, as another user has it, and so that clients do not keep a
# server on this machine waiting.
without_real_time=()
if (($(id -u) == 0)); then
  without_real_time=(prlimit --rtprio=0 --memlock=65536
    setpriv --bounding-set -sys_nice,-ipc_lock,-sys_resource --inh-caps -all)
fi

# What a command has started in the background; all of it ends with the command.
pids=()
stop_all() {
  if ((${#pids[@]})); then kill "${pids[@]}" 2>/dev/null || true; fi
  pids=()
  wait
}
stop_all_at_end() {
  trap stop_all EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
}

# listening NAME COMMAND...: starts it with --listen on a free port, its output in $out/NAME.log; sets `port`.
listening() {
  local name=$1 log=$out/$1.log pid; shift
  for _ in {1..10}; do
    port=$((20000 + RANDOM % 40000))
    "$@" --listen "127.0.0.1:$port" >"$log" 2>&1 </dev/null &
    pid=$!
    sleep 0.5
    if kill -0 "$pid" 2>/dev/null; then
      pids+=("$pid")
      return
    fi
    grep -qsi 'in use' "$log" || break
  done
  cat "$log" >&2
  fail "the $name did not start"
}

# until_true TEXT COMMAND...: waits up to 60 s; $out is where the logs are.
until_true() {
  local text=$1 end=$((SECONDS + 60)); shift
  until "$@"; do
    ((SECONDS < end)) || fail "$text did not happen within 60 s; logs in ${out#"$root"/}"
    sleep 0.02
  done
}

# live_run NAME NETEM OPTION...: a client, which ends, of the server on port $server_port: through a relay of its own,
# with the same seed, so that each meets the same network; without one where NETEM is empty. Leaves NAME.mcap, NAME.json
# and client-NAME.log in $out.
live_run() {
  local name=$1 netem=$2 at=$server_port quiet=(); shift 2
  [[ -t 2 ]] || quiet=(--quiet)
  if [[ -n $netem ]]; then
    listening "relay-$name" "$bin/forcebound-relay" --upstream "127.0.0.1:$server_port" --netem "$netem" --seed 1
    at=$port
  fi
  # 3: the run is whole, but was not passive, as without a law.
  "$bin/forcebound-client" --server "127.0.0.1:$at" "$@" --seed 1 --once "${quiet[@]}" \
    --record "$out/$name.mcap" --summary "$out/$name.json" >"$out/client-$name.log" || (($? == 3)) ||
    { cat "$out/client-$name.log" >&2; fail "the client failed; logs are in ${out#"$root"/}"; }
  if [[ -n $netem ]]; then
    kill "${pids[-1]}"
    unset 'pids[-1]'
  fi
}
