# One run over time: what was felt on the left, what it cost and how punctual it was on the right. The program sets title
# and subtitle.
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
P_min = 0
if (place_of(found, 'P_mJ')) { stats data using 'P_mJ' name 'P' nooutput }
turns = place_of(found, 'x_mrad') || place_of(found, 'y_mrad') || place_of(found, 'z_mrad')
array titles[8] = [turns ? 'Place [mm], turn [mrad]' : 'Place of the device [mm]', 'Depth in the surface [mm]', \
    'Force on the device [N]', 'Stiffness displayed at rest [N/mm]', 'P, energy taken less given [mJ]', \
    'Energy that the law may spend [mJ]', 'Network [ms]', 'Tick [ms]']
array curves[8] = ['x_mm y_mm z_mm x_mrad y_mrad z_mrad', 'penetration_mm', 'requested_N applied_N', 'stiffness_N_per_mm', \
    'P_mJ', 'ledger_mJ', 'round_trip_ms force_age_ms', 'period_ms latency_ms']
array names[8] = ['x y z "about x" "about y" "about z"', '', '"asked for" applied', '', '', '', \
    '"round trip" "age of the force"', 'period "reading to command"']
array hues[8] = ['#0b5fa5 #d9730d #1a8754 #7b4fa3 #8c6d46 #5f6b76', '#0b5fa5', '#9aa4ae #0b5fa5', '#0b5fa5', '#1a8754', \
    '#7b4fa3', '#9aa4ae #d9730d', '#0b5fa5 #7b4fa3']
if (is_cut) { names[4] = '"spikes cut off"'; hues[4] = quiet.' '.hues[4] }
if (place_of(found, 'P_mJ')) { names[5] = '"least '.energy(P_min).'"'; hues[5] = (P_min < -1e-6 ? red : quiet).' '.hues[5] }

eval(begin_head)
row_px = 190
height = head_px + 4 * row_px - 4 + axis_px
eval(begin(width, height))
set multiplot
eval(show_head)
set xrange [0:span_s > 0 ? span_s : 1]
set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead linewidth 1 linecolor rgb grey
do for [p = 1:8] {
  row = (p - 1) % 4
  left_px = p > 4 ? 555 : 60
  shown = panel_names = panel_hues = ''
  # A word of what is shown, and of what is not a curve's name.
  do for [i = 1:words(curves[p])] {
    if (place_of(found, word(curves[p], i))) {
      shown = shown.' '.i
      if (words(names[p]) == words(curves[p]) && words(names[p]) > 1) {
        panel_names = panel_names.'"'.word(names[p], i).'" '
        panel_hues = panel_hues.word(hues[p], i).' '
      }
    }
  }
  if (words(names[p]) == 1) { panel_names = names[p]; panel_hues = hues[p] }
  eval(panel(titles[p], left_px, head_px + row * row_px + 30, left_px + 425, head_px + (row + 1) * row_px - 4))
  set xtics format (row == 3 ? '%g' : '')
  if (p == 1 || p == 5 || p == 6) { set yrange [*:*] } else { set yrange [0:*] }
  if (p == 4 && is_cut) { set yrange [0:stiff_most] }
  if (p == 5 && P_min < -1e-6) { eval(below_zero) } else { unset object 1; unset label 12 }
  if (row == 3) { set xlabel 'time [s]' textcolor rgb ink } else { unset xlabel }
  if (words(shown)) {
    plot for [i in shown] data using 'time_s':(column(word(curves[p], int(i)))) with lines linewidth 1.4 \
        linecolor rgb word(hues[p], words(hues[p]) > words(curves[p]) ? int(i) + 1 : int(i))
  } else {
    eval(no_data)
  }
  eval(hide_head)
}
unset multiplot
