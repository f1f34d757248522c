# Force error over tracking error of each architecture: a panel for each network, a mark for each task and law.
title = 'What each architecture costs: force error at the hand over tracking error'
subtitle = 'filled: fba-exact, passive at both ends; hollow: none, which leaks; a mark for each task, medians over seeds'
networks = architectures = ''
stats data using (networks = with_item(networks, strcol('network')), \
    architectures = with_item(architectures, strcol('architecture')), 0) nooutput

stats data using 'tracking_mm' name 'x' nooutput
stats data using 'force_N' name 'y' nooutput
columns = words(networks) > 3 ? 3 : words(networks)
rows = ceil(words(networks) / real(columns))
top = head_px + 50
panel_px = 300
height = top + rows * panel_px + 20
eval(begin(1000, height))
set output name.'.png'
of(network, architecture, law) = strcol('network') eq network && strcol('architecture') eq architecture && \
    strcol('law') eq law && column('tracking_mm') > 0 ? column('force_N') : NaN

set multiplot
eval(show_title)
eval(only_key(head_px))
plot for [n = 1:words(architectures)] NaN with points pointtype 7 linecolor rgb colour_of_network(n) \
    title word(architectures, n)

eval(after_key)
set logscale xy
set xrange [x_min * 0.8:x_max * 1.25]
set yrange [y_min * 0.8:y_max * 1.25]
set format x '%g'
set format y '%g'
width = 0.94 / columns
do for [p = 1:words(networks)] {
  network = word(networks, p)
  c = (p - 1) % columns
  r = (p - 1) / columns
  set lmargin at screen 0.06 + c * width
  set rmargin at screen 0.06 + (c + 1) * width - 0.05
  set tmargin at screen from_top(top + r * panel_px + 30)
  set bmargin at screen from_top(top + (r + 1) * panel_px - 46)
  set label 10 network at graph 0.5, screen from_top(top + r * panel_px + 18) center font 'DejaVu Sans Bold,10' \
      textcolor rgb ink
  set xlabel 'tracking error [mm]' offset 0, 0.4
  if (c == 0) { set ylabel 'force error [N]' } else { unset ylabel }
  plot for [n = 1:words(architectures)] data \
          using (column('tracking_mm')):(of(network, word(architectures, n), 'fba-exact')) with points pointtype 7 \
          pointsize 1.3 linecolor rgb colour_of_network(n) notitle, \
      for [n = 1:words(architectures)] data \
          using (column('tracking_mm')):(of(network, word(architectures, n), 'none')) with points pointtype 6 \
          pointsize 1.1 linecolor rgb colour_of_network(n) notitle
}
unset multiplot
