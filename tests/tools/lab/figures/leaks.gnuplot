# Energy that each law leaks on a device that is not ideal; the data are those of `forcebound-lab passivity --csv`.
title = 'Energy that an adversary extracts from each law on a real device'
laws = encoders = lates = latencies = ''
stats data using (laws = with_item(laws, strcol('law')), encoders = with_item(encoders, strcol('encoder_m')), \
    lates = with_item(lates, strcol('late_share')), latencies = with_item(latencies, strcol('latency_s')), 0) nooutput
late_most = 0
do for [late in lates] { late_most = late + 0 > late_most ? late + 0 : late_most }
subtitle = sprintf('the worst adversary; solid: exact ticks, dashed: %g %% of them late; below the red line: passive', 100 * late_most)
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

panel_px = 250
height = head_px + words(encoders) * panel_px + 50
eval(begin(1000, height))
set output name.'.png'
set multiplot
eval(show_title)
set lmargin at screen 0.1
set rmargin at screen 0.98
set logscale y
set yrange [guarantee_J / 5:1e4]
set ytics ('1 nJ' 1e-9, '1 µJ' 1e-6, '1 mJ' 1e-3, '1 J' 1, '1 kJ' 1e3)
set ylabel 'energy extracted'
set arrow 1 from graph 0, first guarantee_J to graph 1, first guarantee_J nohead dashtype 2 linecolor rgb red
leak(law, encoder, late) = strcol(1) eq law && strcol(2) eq encoder && strcol(3) eq late ? column(5) : NaN
do for [e = 1:words(encoders)] {
  encoder = word(encoders, e)
  set tmargin at screen from_top(head_px + (e - 1) * panel_px + 34)
  set bmargin at screen from_top(head_px + e * panel_px - 20)
  set label 10 (encoder + 0 > 0 ? sprintf('Encoder of %g µm', 1e6 * encoder) : 'Ideal encoder') at graph 0, graph 1 left \
      offset 0, 0.8 font 'DejaVu Sans Bold,11' textcolor rgb ink
  if (e == 1) { eval(key_above) } else { unset key }
  if (e == words(encoders)) { set xlabel 'latency from reading to actuator [µs]' }
  # Each law a little aside, so that none hides another.
  plot for [i = 1:words(laws)] for [l = 1:words(lates)] $worst \
      using (1e6 * column(4) + 2 * i):(leak(word(laws, i), encoder, word(lates, l))) \
      with linespoints pointtype 7 pointsize 0.8 linewidth 1.6 dashtype l linecolor rgb colour_of_law(word(laws, i)) \
      title l == 1 ? word(laws, i) : ''
  unset label 1; unset label 2
}
unset multiplot
