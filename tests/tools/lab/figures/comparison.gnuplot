# Transparency and stability of each law: a row for each, a mark in it for each network.
title = 'How stiff a wall each law displays, and how still it holds the force'
subtitle = 'medians over scenes and walls, on a device with encoder, latency and late ticks'
laws = all = ''
stats data using (laws = with_item(laws, strcol('law')), all = with_item(all, strcol('network')), 0) nooutput
# Those to draw: these three, or all if one of them is missing.
networks = '"none" "delay 10ms" "delay 50ms" '
do for [network in networks] { if (!place_of(all, network)) { networks = all } }

row_px = 8 + 11 * words(networks)
top = head_px + 36 + 18 * ceil((words(networks) + 2) / 3.)
height = top + row_px * words(laws) + 60
eval(begin(1000, height))
set output name.'.png'

line(network) = (place_of(networks, network) - (words(networks) + 1) / 2.) * 0.8 / words(networks)
y(law, network) = place_of(laws, law) + line(network)
# Zero has no place on a logarithmic axis, and what is not known is as bad as can be.
inside(value) = value < least ? least : value > highest ? highest : value
place(quantity) = strcol(quantity) eq 'nan' ? worst : inside(column(quantity))
of(network) = strcol('network') eq network
mark(sound) = sound > 0 ? 7 : 2

set multiplot
eval(show_title)
eval(only_key(head_px))
plot for [n = 1:words(networks)] NaN with linespoints pointtype 7 linecolor rgb colour_of_network(n) \
        title 'network: '.word(networks, n), \
    NaN with points pointtype 2 linewidth 1.5 linecolor rgb quiet title 'does not rest, or not passive', \
    NaN with points pointtype 6 pointsize 1.9 linewidth 2 linecolor rgb green title 'no law is better in both'

eval(after_key)
set logscale x
set yrange [words(laws) + 0.5:0.5]
set tmargin at screen from_top(top)
set bmargin at screen from_top(height - 60)
set format x '%g'
set grid noytics
do for [i = 1:words(laws):2] {
  set object i rectangle from graph 0, first i - 0.5 to graph 1, first i + 0.5 behind fillcolor rgb '#f4f6f8' \
      fillstyle solid noborder
}
set ytics ()
set for [i = 1:words(laws)] ytics add (word(laws, i) i)
do for [panel = 1:2] {
  if (panel == 1) {
    quantity = 'displayed_over_requested'
    least = 0.005
    worst = least
    highest = 1.2
    set xrange [0.004:1.3]
    set xtics ('≤ 0.5 %%' 0.005, '2 %%' 0.02, '5 %%' 0.05, '10 %%' 0.1, '20 %%' 0.2, '50 %%' 0.5, '100 %%' 1)
    set xlabel 'displayed over requested stiffness'
    set label 10 'Transparency: farther right is better' at graph 0.5, screen from_top(top - 14) center \
        font 'DejaVu Sans Bold,11' textcolor rgb ink
    set lmargin at screen 0.11
    set rmargin at screen 0.54
  } else {
    quantity = 'restlessness'
    least = 0.01
    worst = highest = 3.7
    set xrange [0.008:4]
    set xtics ('≤ 0.01' 0.01, '0.05' 0.05, '0.1' 0.1, '0.2' 0.2, '0.5' 0.5, '1' 1, '2' 2)
    set xlabel "restlessness: the force's deviation over its mean"
    set label 10 'Stability: farther left is better'
    set lmargin at screen 0.56
    set rmargin at screen 0.98
    set ytics format '' ()
  }
  plot for [n = 1:words(networks)] data using (least / 10): \
          (of(word(networks, n)) ? y(strcol('law'), word(networks, n)) : NaN): \
          (place(quantity) - least / 10):(0) with vectors nohead linewidth 1 \
          linecolor rgb colour_of_network(n) notitle, \
      for [n = 1:words(networks)] data using (of(word(networks, n)) ? place(quantity) : NaN): \
          (y(strcol('law'), word(networks, n))):(mark(column('rests_and_passive'))) \
          with points pointtype variable pointsize 1 linewidth 1.5 linecolor rgb colour_of_network(n) notitle, \
      data using (column('unbeaten') > 0 && place_of(networks, strcol('network')) ? \
          place(quantity) : NaN):(y(strcol('law'), strcol('network'))) \
          with points pointtype 6 pointsize 1.9 linewidth 2 linecolor rgb green notitle
}
unset multiplot
