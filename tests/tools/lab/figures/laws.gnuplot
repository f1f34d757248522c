# Several runs over each other. A run's name begins with its law. The program sets title and subtitle.
quantities = 'penetration_mm force_N P_mJ stiffness_N_per_mm'
# The runs that have values of each.
array shown[4] = ['', '', '', '']
with_run(list, quantity) = strcol(quantity) eq 'nan' ? list : with_item(list, strcol('run'))
law_of(run) = word(run, 1)
# Which run of its law it is: 1 for the first.
turn_of(list, run) = sum [i = 1:place_of(list, run)] (law_of(word(list, i)) eq law_of(run))
span_s = 0
stats data using (span_s = column('time_s') > span_s ? column('time_s') : span_s, 0) nooutput
do for [p = 1:4] {
  runs = ''
  stats data using (runs = with_run(runs, word(quantities, p)), 0) nooutput
  shown[p] = runs
}
# Force at hardly any depth is a spike of stiffness: what is higher than this is cut off.
stiff_most = stiff_highest = 0
do for [run in shown[4]] {
  stats data using (strcol('run') eq run ? column('stiffness_N_per_mm') : NaN) nooutput
  stiff_most = 3 * STATS_up_quartile > stiff_most ? 3 * STATS_up_quartile : stiff_most
  stiff_highest = STATS_max > stiff_highest ? STATS_max : stiff_highest
}
is_cut = stiff_most > 0 && stiff_highest > stiff_most
P_most = 0
if (words(shown[3])) {
  stats data using (P_most = abs(column('P_mJ')) > P_most ? abs(column('P_mJ')) : P_most, 0) nooutput
}
panel_px = 220
height = head_px + 4 * panel_px + 50
eval(begin(1000, height))
set output name.'.png'

curve(run, quantity) = strcol('run') eq run ? column(quantity) : NaN
array titles[4] = ['Penetration', 'Force on the device', \
    'Passivity: energy taken less energy returned, logarithmic beyond 1 mJ', \
    'Displayed stiffness at rest: depth changes by less than 5 mm/s'.(is_cut ? sprintf('; cut off above %.2g N/mm', stiff_most) : '')]
array labels[4] = ['penetration [mm]', 'magnitude [N]', 'P [mJ]', 'K [N/mm]']

set multiplot
eval(show_title)
set lmargin at screen 0.085
set rmargin at screen 0.98
set xrange [0:span_s > 0 ? span_s : 1]
do for [p = 1:4] {
  set tmargin at screen from_top(head_px + (p - 1) * panel_px + 34)
  set bmargin at screen from_top(head_px + p * panel_px - 20)
  set label 10 titles[p] at graph 0, graph 1 left offset 0, 0.8 font 'DejaVu Sans Bold,11' textcolor rgb ink
  set ylabel labels[p]
  unset nonlinear y
  set ytics autofreq
  if (p == 3) {
    # A law that is not passive returns a thousand times the energy of the others.
    set yrange [*:*]
    set nonlinear y via asinh(y) inverse sinh(y)
    set ytics (0)
    do for [power = (P_most > 100 ? 1 : 0):7:(P_most > 1000 ? 2 : 1)] { set ytics add (10**power, -10**power) }
    set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead dashtype 2 linecolor rgb red
  } else {
    unset arrow 1
    if (p == 4 && is_cut) { set yrange [0:stiff_most] } else { set yrange [0:*] }
  }
  if (p == 2) { eval(key_above) } else { unset key }
  if (p == 4) { set xlabel 'time [s]' }
  runs = shown[p]
  if (words(runs)) {
    plot for [run in runs] data using 'time_s':(curve(run, word(quantities, p))) with lines linewidth 1.5 \
        dashtype turn_of(runs, run) linecolor rgb colour_of_law(law_of(run)) title run
  } else {
    eval(no_data)
  }
  unset label 1; unset label 2
}
unset multiplot
