# Energy that each law leaks on a device that is not ideal; the data are those of `forcebound-lab passivity --csv`.
title = 'Energy that an adversary extracts from each law on a real device'
laws = encoders = lates = latencies = ''
stats data using (laws = with_item(laws, strcol('law')), encoders = with_item(encoders, strcol('encoder_m')), \
    lates = with_item(lates, strcol('late_share')), latencies = with_item(latencies, strcol('latency_s')), 0) nooutput
late_most = 0
do for [late in lates] { late_most = late + 0 > late_most ? late + 0 : late_most }
subtitle = sprintf('the worst adversary; solid: exact ticks, dotted: %g %% of them late; a law is passive below the red line', 100 * late_most)
guarantee_J = 1e-9
passive_J = 0.3 * guarantee_J
# The worst over all adversaries, kept for the plot: law, encoder, late ticks, latency.
set print $worst
do for [law in laws] { do for [encoder in encoders] { do for [late in lates] { do for [latency in latencies] {
  leak_J = 0
  stats data using (strcol('law') eq law && strcol('encoder_m') eq encoder && strcol('late_share') eq late && \
      strcol('latency_s') eq latency ? \
      (leak_J = -column('least_P_J') > leak_J ? -column('least_P_J') : leak_J, 0) : 0) nooutput
  print sprintf('%s,%s,%s,%s,%.6g', law, encoder, late, latency, leak_J > passive_J ? leak_J : passive_J)
}}}}
set print
set datafile nocolumnheaders

eval(begin_head)
do for [law in laws] { eval(add_key(law, colour_of_law(law), 0)) }
row_px = 250
left_px = 74
top = head_px + 30
height = top + words(encoders) * row_px - 62 + axis_px
eval(begin(width, height))
set multiplot
eval(show_head)
set logscale y
set yrange [guarantee_J / 5:1e4]
set ytics ('1 nJ' 1e-9, '1 µJ' 1e-6, '1 mJ' 1e-3, '1 J' 1, '1 kJ' 1e3)
set arrow 1 from graph 0, first guarantee_J to graph 1, first guarantee_J nohead linewidth 1.5 linecolor rgb red
leak(law, encoder, late) = strcol(1) eq law && strcol(2) eq encoder && strcol(3) eq late ? column(5) : NaN
do for [e = 1:words(encoders)] {
  encoder = word(encoders, e)
  eval(panel('Energy extracted, '.(encoder + 0 > 0 ? sprintf('encoder of %g µm', 1e6 * encoder) : 'ideal encoder'), left_px, \
      top + (e - 1) * row_px, width - 30, top + e * row_px - 62))
  if (e == words(encoders)) { set xlabel 'latency from reading to actuator [µs]' }
  # Each law a little aside, so that none hides another.
  plot for [i = 1:words(laws)] for [l = 1:words(lates)] $worst \
      using (1e6 * column(4) + 2 * i):(leak(word(laws, i), encoder, word(lates, l))) \
      with linespoints pointtype 7 pointsize 0.8 linewidth 1.6 dashtype dash_of(1 - l) linecolor rgb colour_of_law(word(laws, i))
  eval(hide_head)
}
unset multiplot
