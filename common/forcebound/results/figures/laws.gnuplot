# Runs side by side: a column for each, below each other force, depth and passivity. The program sets title and subtitle.
# A run without a name is the reference of its law, drawn grey in the columns of that law.
runs = references = ''
span_s = 0
stats data using (runs = strcol('run') eq '' ? runs : with_item(runs, strcol('run')), \
    references = strcol('run') eq '' ? with_item(references, strcol('law')) : references, \
    span_s = column('time_s') > span_s ? column('time_s') : span_s, 0) nooutput
array law_of[words(runs) + 1]
stats data using (i = place_of(runs, strcol('run')), i ? (law_of[i] = strcol('law'), 0) : 0) nooutput

quantities = 'force_N penetration_mm P_mJ'
units = '"force on the device [N]" "depth [mm]" "P [mJ]"'
array least[3]
array most[3]
do for [q = 1:3] {
  least[q] = most[q] = 0
  stats data using (value = column(word(quantities, q)), least[q] = value < least[q] ? value : least[q], \
      most[q] = value > most[q] ? value : most[q], 0) nooutput
  if (most[q] == least[q]) { most[q] = 1 }
}

left_px = 86
gap_px = 20
fits_px = (width - left_px - edge_px) / words(runs) - gap_px
panel_px = fits_px > 200 ? fits_px : 200
width = left_px + words(runs) * (panel_px + gap_px) + edge_px
subtitle = subtitle.'. P: energy that the device took less what it gave; below 0 it gave the hand energy'
eval(begin_head)
if (words(references)) { eval(add_key('felt without a network', reference, 0)) }
heading(run) = wrapped(run, int(panel_px / 9))
heading_lines = 0
do for [run in runs] {
  heading_lines = lines_of(heading(run)) > heading_lines ? lines_of(heading(run)) : heading_lines
}
row_px = 200
top = head_px + 18 * heading_lines + 22
height = top + 3 * row_px - 30 + axis_px
eval(begin(width, height))

set multiplot
eval(show_head)
set xrange [0:span_s > 0 ? span_s : 1]
set border 2
shown(run, q) = strcol('run') eq run ? column(word(quantities, q)) : NaN
shown_reference(law, q) = strcol('run') eq '' && strcol('law') eq law ? column(word(quantities, q)) : NaN
set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead linewidth 1 linecolor rgb grey
do for [q = 1:3] {
  set tmargin at screen from_top(top + (q - 1) * row_px)
  set bmargin at screen from_top(top + q * row_px - 30)
  room = 0.05 * (most[q] - least[q])
  set yrange [least[q] < 0 ? least[q] - room : 0:most[q] + room]
  if (q == 3) {
    set xlabel 'time [s]' textcolor rgb ink
    if (least[q] < 0) { eval(below_zero) }
  }
  do for [r = 1:words(runs)] {
    run = word(runs, r)
    law = law_of[r]
    set lmargin at screen from_left(left_px + (r - 1) * (panel_px + gap_px))
    set rmargin at screen from_left(left_px + (r - 1) * (panel_px + gap_px) + panel_px)
    if (r == 1) {
      set label 13 word(units, q) at screen from_left(15), graph 0.5 center rotate textcolor rgb ink
      set ytics format '%g'
    } else {
      unset label 13
      set ytics format ''
    }
    set xtics format (q == 3 ? '%g' : '')
    unset label 10
    if (q == 1) {
      set label 10 heading(run) at graph 0, screen from_top(head_px + 16) left font bold(11) textcolor rgb colour_of_law(law)
    }
    if (q == 3) {
      # A device that is not simulated does not know P.
      known = least_P = 0
      stats data using (P = shown(run, q), P == P ? (known = 1, least_P = P < least_P ? P : least_P, 0) : 0) nooutput
      set label 10 (known ? 'least P '.energy(least_P) : 'P not known') at graph 0, graph 1 left offset 0, 0.6 font ',10' \
          textcolor rgb (least_P < -1e-6 ? red : ink)
    }
    plot data using 'time_s':(shown_reference(law, q)) with lines linewidth 3 linecolor rgb reference, \
        data using 'time_s':(shown(run, q)) with lines linewidth 1.2 linecolor rgb colour_of_law(law)
    eval(hide_head)
  }
}
unset multiplot
