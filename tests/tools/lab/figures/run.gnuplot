# One run over time. The program sets title and subtitle.
columns = 'x_mm y_mm z_mm x_mrad y_mrad z_mrad penetration_mm requested_N applied_N stiffness_N_per_mm P_mJ ledger_mJ '. \
    'round_trip_ms force_age_ms period_ms latency_ms'
found = ''
span_s = 0
with_column(list, c) = strcol(c) eq 'nan' ? list : with_item(list, c)
stats data using (span_s = column('time_s') > span_s ? column('time_s') : span_s, 0) nooutput
do for [c in columns] { stats data using (found = with_column(found, c), 0) nooutput }

stiff_most = is_cut = 0
if (place_of(found, 'stiffness_N_per_mm')) {
  # Force at hardly any depth is a spike of stiffness: what is higher than this is cut off.
  stats data using 'stiffness_N_per_mm' nooutput
  stiff_most = 3 * STATS_up_quartile
  is_cut = stiff_most > 0 && STATS_max > stiff_most
}
array titles[8] = ['Position', 'Penetration, where the surface is known', 'Force on the device', \
    'Displayed stiffness at rest: depth changes by less than 5 mm/s'.(is_cut ? '; spikes cut off' : ''), \
    'Passivity: energy the device took less energy it returned', 'Ledger: energy that the law may spend', \
    'Network', 'Tick']
array labels[8] = ['mm; mrad', 'depth [mm]', 'magnitude [N]', 'K [N/mm]', 'P [mJ]', 'E [mJ]', 'time [ms]', 'time [ms]']
array curves[8] = ['x_mm y_mm z_mm x_mrad y_mrad z_mrad', 'penetration_mm', 'requested_N applied_N', 'stiffness_N_per_mm', \
    'P_mJ', 'ledger_mJ', 'round_trip_ms force_age_ms', 'period_ms latency_ms']
array names[8] = ['x y z "about x" "about y" "about z"', '""', '"asked for" applied', '""', '""', '""', \
    '"round trip" "age of the force"', '"period" "reading to command"']
array hues[8] = ['#0b5fa5 #d9730d #1a8754 #7b4fa3 #8c6d46 #5f6b76', '#0b5fa5', '#b0b0b0 #0b5fa5', '#0b5fa5', '#1a8754', \
    '#7b4fa3', '#8c6d46 #d9730d', '#0b5fa5 #7b4fa3']

panel_px = 180
height = head_px + 8 * panel_px + 50
eval(begin(1000, height))
set output name.'.png'

set multiplot
eval(show_title)
set lmargin at screen 0.085
set rmargin at screen 0.98
set xrange [0:span_s > 0 ? span_s : 1]
do for [p = 1:8] {
  set tmargin at screen from_top(head_px + (p - 1) * panel_px + 34)
  set bmargin at screen from_top(head_px + p * panel_px - 20)
  set label 10 titles[p] at graph 0, graph 1 left offset 0, 0.8 font 'DejaVu Sans Bold,11' textcolor rgb ink
  set ylabel labels[p]
  if (p == 1 || p == 5 || p == 6) { set yrange [*:*] } else { set yrange [0:*] }
  if (p == 4 && is_cut) { set yrange [0:stiff_most] }
  if (p == 5) { set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead dashtype 2 linecolor rgb red } else { unset arrow 1 }
  if (words(names[p]) > 1) { eval(key_above) } else { unset key }
  if (p == 8) { set xlabel 'time [s]' }
  shown = ''
  do for [i = 1:words(curves[p])] { if (place_of(found, word(curves[p], i))) { shown = shown.' '.i } }
  if (words(shown)) {
    plot for [i in shown] data using 'time_s':(column(word(curves[p], int(i)))) with lines linewidth 1.5 \
        linecolor rgb word(hues[p], int(i)) title word(names[p], int(i))
  } else {
    eval(no_data)
  }
  unset label 1; unset label 2
}
unset multiplot
