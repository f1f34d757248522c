# Stages of the gate and of the night: each a command, whose time and tests are told at the end. Sourced.
source "$(dirname "${BASH_SOURCE[0]}")/../deploy/lib.sh"
cd "$root"
passed=0 failed=0 skipped=0 failed_stages=()
limit_s=$((1 << 30))
printf -v table '%-14s %10s %12s  %s' stage 'wall [s]' 'cpu [s]' tests

# Sets `used` to the seconds of processor that all commands so far have taken. Not by $(...): a subshell counts anew.
count_processor_s() {
  times >build/log/times
  used=$(tail -n 1 build/log/times | tr -s 'ms ' '   ' | awk '{ printf "%.0f", 60 * ($1 + $3) + $2 + $4 }')
}

# within_limit COMMAND...: ends it, and all that it has started, `limit_s` seconds after the first stage began.
within_limit() {
  local left=$((limit_s - SECONDS))
  ((left > 0)) || { say "no time left"; return 124; }
  timeout -k 20 "$left" "$@" &
  # It has a process group of its own, which Ctrl-C does not reach.
  trap 'kill $!' INT TERM
  wait $!
}

# stage NAME COMMAND...: runs it, and keeps its seconds and what deploy/test says last of the tests. A stage that has run
# out of time has failed.
stage() {
  local name=$1 log=$root/build/log/stage-$1.log start=$SECONDS used before status=0 tests= word=passed; shift
  mkdir -p "${log%/*}"
  count_processor_s
  before=$used
  say "=== $name: $*"
  (within_limit "$@") 2>&1 </dev/null | tee "$log" || status=$?
  if [[ $(grep -E '^Tests: ' "$log" | tail -n 1) =~ ([0-9]+)\ passed,\ ([0-9]+)\ failed,\ ([0-9]+)\ skipped ]]; then
    tests=${BASH_REMATCH[0]}
    passed=$((passed + BASH_REMATCH[1])) failed=$((failed + BASH_REMATCH[2])) skipped=$((skipped + BASH_REMATCH[3]))
  fi
  if ((status == 124)); then tests='out of time'; fi
  count_processor_s
  table+=$(printf '\n%-14s %10d %12d  %s' "$name" $((SECONDS - start)) $((used - before)) "$tests")
  if ((status)); then
    failed_stages+=("$name")
    failed=$((failed ? failed : 1))
    word=FAILED
  fi
  say "=== $name $word after $((SECONDS - start)) s"
  return "$status"
}

# finish WHAT: last the tests, for whoever reads only the end of this to see that they ran.
finish() {
  local word=passed
  if ((${#failed_stages[@]})); then word="FAILED (${failed_stages[*]})"; fi
  say "=== $1 $word after $SECONDS s"
  say "$table"
  say "$passed passed, $failed failed, $skipped skipped"
  ((${#failed_stages[@]} == 0))
}
