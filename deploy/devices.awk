# What deploy/devices says of the recordings of a client and of a device's stand-in: -v what=contact, run, unplugged or
# ended. Files: of the device; for run and unplugged the client's before it.
BEGIN { FS = "," }
what != "contact" && FNR == 1 { file++; next }
function length_of(x, y, z) { return sqrt(x * x + y * y + z * z) }
# Without the sign of a zero.
function force_as_text(x, y, z) { return sprintf("%.9g %.9g %.9g", x + 0, y + 0, z + 0) }

what == "contact" { newest = length_of($6, $7, $8); next }

# The client: each tick's reading and command.
what != "ended" && file == 1 {
  ticks++
  if (ticks > 1) period[ticks - 1] = 1e6 * ($1 - read_at)
  read_at = $1
  reading[ticks] = $2
  at[ticks] = $4
  commanding[ticks] = $5
  size[ticks] = length_of($6, $7, $8)
  wanted[ticks] = force_as_text($6, $7, $8)
  next
}

# The device.
{
  force = length_of($6, $7, $8)
  least_J = $10
  if ($2 == "unplug") unplugged_at = $1
  if ($2 == "plug") plugged_at = $1
  if ($2 == "mark") { marked_at = $1; held = force }
}
what == "run" && $2 == "command" { add_command($1, force_as_text($6, $7, $8)) }
what == "unplugged" && $2 == "command" && plugged_at && force > 0 { add_return($1, force) }
what == "ended" && marked_at && !ended_by && force == 0 { ended_after = $1 - marked_at; ended_by = $2 }
what == "ended" && marked_at && !ended_by { last_at = $1 }

# The newest tick that commanded this by then; one that is 20 ms old cannot be it.
function add_command(time, text,    i) {
  while (newest_tick < ticks && at[newest_tick + 1] <= time) newest_tick++
  for (i = newest_tick; i > 0 && time - at[i] < 0.02; i--) {
    if (wanted[i] != text) continue
    if (!(i in arrived)) { arrived[i] = 1; delay[++arrivals] = 1e3 * (time - at[i]) }
    return
  }
  if (text != "0 0 0") altered++
}

# In 0.1 s a ramp of 0.5 s lets a fifth of the largest force pass, in 0.3 s three.
function add_return(time, newtons) {
  if (!back_at) back_at = time
  if (time < back_at + 0.1 && newtons > early) early = newtons
  if (time < back_at + 0.3 && newtons > later) later = newtons
}

# Heapsort, from 1.
function sift(a, i, n,    child, t) {
  while ((child = 2 * i) <= n) {
    if (child < n && a[child + 1] > a[child]) child++
    if (a[i] >= a[child]) return
    t = a[i]; a[i] = a[child]; a[child] = t
    i = child
  }
}
function sort_numbers(a, n,    i, t) {
  for (i = 1; i <= n; i++) a[i] += 0
  for (i = int(n / 2); i >= 1; i--) sift(a, i, n)
  for (i = n; i > 1; i--) { t = a[1]; a[1] = a[i]; a[i] = t; sift(a, 1, i - 1) }
}
function at_share(a, n, share,    i) { i = int(share * n + 0.5); return a[i < 1 ? 1 : i > n ? n : i] }
function median_and_p99(a, n) {
  if (!n) return "none"
  sort_numbers(a, n)
  return sprintf("%.3g, %.3g", at_share(a, n, 0.5), at_share(a, n, 0.99))
}

END {
  if (what == "contact") exit !(newest > 0.5)
  if (what == "run") {
    sort_numbers(period, ticks - 1)
    printf "%.0f, %.0f, %.0f\n", at_share(period, ticks - 1, 0.5), at_share(period, ticks - 1, 0.99), period[ticks - 1]
    print median_and_p99(reading, ticks)
    print median_and_p99(commanding, ticks)
    printf "%.2f\n", ticks ? 100 * arrivals / ticks : 0
    printf "%d\n", altered
    print median_and_p99(delay, arrivals)
    printf "%.3g\n", 1e3 * least_J
  }
  if (what == "unplugged") {
    for (i = 1; i <= ticks && at[i] < unplugged_at; i++) { }
    for (; i <= ticks && size[i] > 0; i++) { }
    printf "%.3g\n", 1e3 * (at[i] - unplugged_at)
    printf "%.3g\n", back_at - plugged_at
    printf "%.3g, %.3g\n", early, later
  }
  if (what == "ended") {
    if (!held) print "no contact"
    else if (!ended_by) printf "never (%.2g s)\n", last_at - marked_at
    else printf "%.3g, %s\n", 1e3 * ended_after, ended_by == "release" ? "device" : "driver"
  }
}
