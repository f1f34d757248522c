# The stiffest wall that comes to rest: a panel for each hand, a row for each law, a mark in it for each delay.
title = 'The stiffest virtual wall that comes to rest'
subtitle = 'ideal device, b = 30 N s/m, T = 1 ms, delay t each way; '. \
    'triangle: all up to 1000 N/mm; cross: not even 0.1 N/mm'
theories = "'2b/T' 'b/(T/2 + 2t)'"
hands = laws = delays = ''
stats data using (hands = with_item(hands, strcol('hand')), delays = with_item(delays, strcol('delay_ms')), \
    laws = strstrt(theories, "'".strcol('law')."'") ? laws : with_item(laws, strcol('law')), 0) nooutput

row_px = 8 + 9 * words(delays)
top = head_px + 54
height = top + row_px * words(laws) + 62
eval(begin(1000, height))
set output name.'.png'

# Beyond what was tried: marks on the edges.
least = 0.05
most = 1000.
inside(stiffness) = stiffness < least ? least : stiffness
mark(stiffness) = stiffness >= most ? 9 : stiffness < least ? 2 : 7
line(delay) = (place_of(delays, delay) - (words(delays) + 1) / 2.) * 0.8 / words(delays)
y(law, delay) = place_of(laws, law) + line(delay)
stiffness(hand, delay, law) = strcol('hand') eq hand && strcol('delay_ms') eq delay && strcol('law') eq law ? \
    column('stiffness_N_per_mm') : NaN
of(hand, delay) = strcol('hand') eq hand && strcol('delay_ms') eq delay && place_of(laws, strcol('law')) > 0

set multiplot
eval(show_title)
eval(only_key(head_px))
plot NaN with lines linewidth 1.5 linecolor rgb ink title '2b/T', \
    NaN with lines linewidth 1.5 dashtype 3 linecolor rgb quiet title 'b/(T/2 + 2t)', \
    for [d = 1:words(delays)] NaN with linespoints pointtype 7 pointsize 0.8 linewidth 1 \
        linecolor rgb colour_of_network(d) title 't = '.word(delays, d).' ms'

eval(after_key)
set logscale x
set xrange [0.035:1600]
set yrange [words(laws) + 0.5:0.5]
set tmargin at screen from_top(top)
set bmargin at screen from_top(height - 62)
set format x '%g'
set xtics (0.1, 1, 10, 100, 1000)
set grid noytics
set label 3 'stiffness of the wall [N/mm]' at screen 0.55, screen from_top(height - 18) center textcolor rgb ink
# A panel's frame, and a band behind every other law.
do for [i = 1:words(laws):2] {
  set object i rectangle from graph 0, first i - 0.5 to graph 1, first i + 0.5 behind fillcolor rgb '#f4f6f8' \
      fillstyle solid noborder
}
set for [i = 1:words(laws)] ytics add (word(laws, i) i)
width = 0.87 / words(hands)
do for [h = 1:words(hands)] {
  hand = word(hands, h)
  set lmargin at screen 0.11 + (h - 1) * width
  set rmargin at screen 0.11 + h * width - 0.02
  set label 10 'under a '.hand.' hand' at graph 0.5, screen from_top(top - 14) center \
      font 'DejaVu Sans Bold,11' textcolor rgb ink
  if (h == 2) {
    unset label 3
    set ytics format '' ()
  }
  plot for [d = 1:words(delays)] data using (inside(stiffness(hand, word(delays, d), 'b/(T/2 + 2t)'))):(0.5): \
          (0):(words(laws)) with vectors nohead linewidth 1.5 dashtype 3 linecolor rgb colour_of_network(d) notitle, \
      data using (stiffness(hand, word(delays, 1), '2b/T')):(0.5):(0):(words(laws)) with vectors nohead \
          linewidth 1.5 linecolor rgb ink notitle, \
      for [d = 1:words(delays)] data using (least / 10): \
          (of(hand, word(delays, d)) ? y(strcol('law'), word(delays, d)) : NaN): \
          (inside(column('stiffness_N_per_mm')) - least / 10):(0) with vectors nohead linewidth 1 \
          linecolor rgb colour_of_network(d) notitle, \
      for [d = 1:words(delays)] data using (of(hand, word(delays, d)) ? inside(column('stiffness_N_per_mm')) : NaN): \
          (y(strcol('law'), word(delays, d))):(mark(column('stiffness_N_per_mm'))) with points pointtype variable pointsize 0.8 linecolor rgb colour_of_network(d) notitle
}
unset multiplot
