# What all figures share. `name` of the files, and a figure's own `title` and `subtitle`, are set above or below.
set encoding utf8
set datafile separator comma
set datafile columnheaders
data = name.'.csv'

ink = '#24292f'
quiet = '#57606a'
faint = '#e3e6ea'
red = '#c1272d'
orange = '#d9730d'
blue = '#0b5fa5'
green = '#1a8754'
violet = '#7b4fa3'
brown = '#8c6d46'
grey = '#b0b0b0'
reference = '#9aa4ae'

# Told apart with the common colour blindnesses as well.
colour_of_law(law) = law eq 'none' ? red : law eq 'fba-less' ? orange : law eq 'fba-more' ? blue : \
    law eq 'fba-exact' ? green : law eq 'aol' ? '#c9a227' : law eq 'eba' ? '#5f6b76' : law eq 'mbpa' ? brown : \
    law eq 'pspm' ? '#4b9da9' : law eq 'sfa' ? '#b5838d' : law eq 'tdpa' ? violet : law eq 'tdpa-2port' ? '#a98bc9' : \
    law eq 'iss' ? '#2a9d8f' : law eq 'tdpa-er' ? '#bc6c25' : law eq 'tdpa-priority' ? '#d0679d' : \
    law eq 'tla' ? '#6a994e' : law eq 'vc' ? '#e07a5f' : law eq 'wave' ? '#3d405b' : quiet
# From near to far.
network_colours = '#7fb2dd #0b5fa5 #d9730d #7b1e3a #1a8754 #7b4fa3 #8c6d46 #5f6b76 #c1272d #24292f'
colour_of_network(i) = word(network_colours, (i - 1) % words(network_colours) + 1)

# Lists of quoted words, for `for [x in list]`: those of a column in their order, and an item's place in them.
with_item(list, item) = strstrt(list, '"'.item.'"') ? list : list.'"'.item.'" '
place_of(list, item) = sum [i = 1:words(list)] (word(list, i) eq item ? i : 0)

# gnuplot's svg knows no weight of a font.
bold(points) = sprintf(format eq 'svg' ? 'DejaVu Sans,%d' : 'DejaVu Sans:Bold,%d', points)
# A place counted in pixels from the picture's left or upper edge, as a share of its width or height.
from_left(pixels) = pixels / real(width)
from_top(pixels) = 1 - pixels / real(height)

# Where nothing else is set: gnuplot -e "format = 'svg'" draws one.
if (!exists('format')) format = 'png'
width = 1000
# The same picture in each format: pngcairo has 96 pixels in an inch, 72 points.
begin(width, height) = (format eq 'pdf' ? sprintf("set terminal pdfcairo fontscale 0.667 noenhanced rounded size %gin,%gin", \
    width / 96., height / 96.) : sprintf("set terminal %s noenhanced rounded size %d,%d", \
    format eq 'svg' ? 'svg fontscale 1.333' : 'pngcairo', width, height)). \
    " font 'DejaVu Sans,11' background rgb '#ffffff'; set output name.'.'.format"

# Text in lines of at most so many letters, and how many lines those are.
last_blank = 0
last_blank_of(text, most) = (last_blank = 0, sum [i = 1:most + 1] (text[i:i] eq ' ' ? (last_blank = i) : 0), last_blank)
wrapped(text, most) = strlen(text) <= most ? text : last_blank_of(text, most) > 1 ? \
    text[1:last_blank - 1]."\n".wrapped(text[last_blank + 1:*], most) : text[1:most]."\n".wrapped(text[most + 1:*], most)
lines_of(text) = 1 + sum [i = 1:strlen(text)] (text[i:i] eq "\n")

# The head: title, subtitle, and a line of what the marks and colours mean, each item a mark and its words. `begin_head`
# comes after title and subtitle, `add_key` for each item, then `head_px` is its height, and `show_head` draws it.
edge_px = 14
# Room for an axis with numbers and name below a panel.
axis_px = 64
title_letter_px = 11.6
letter_px = 7.4
key_letter_px = 8
begin_head = "shown_title = wrapped(title, int((width - 2 * edge_px) / title_letter_px)); \
    shown_subtitle = wrapped(subtitle, int((width - 2 * edge_px) / letter_px)); keys = 0; key_x_px = edge_px; \
    head_px = 14 + 24 * lines_of(shown_title) + 17 * lines_of(shown_subtitle); key_y_px = head_px + 15"
array key_text[60]; array key_colour[60]; array key_mark[60]; array key_left[60]; array key_top[60]
mark_px = 34
dash_of(mark) = mark < 0 ? 3 : 1
# A mark above 0 is a point of that type; 0 is a line, below 0 a dashed one.
add_key(text, colour, mark) = sprintf('keys = keys + 1; key_text[keys] = "%s"; key_colour[keys] = "%s"; key_mark[keys] = %d; \
    key_width = strlen(key_text[keys]) * key_letter_px + (key_mark[keys] > 0 ? 18 : mark_px); \
    if (key_x_px > edge_px && key_x_px + key_width > width - edge_px) { key_x_px = edge_px; key_y_px = key_y_px + 19 }; \
    key_left[keys] = key_x_px; key_top[keys] = key_y_px; key_x_px = key_x_px + key_width + 18; head_px = key_y_px + 14', \
    text, colour, mark)
show_head = "set label 1 shown_title at screen from_left(edge_px), screen from_top(24) left font bold(14) textcolor rgb ink; \
    set label 2 shown_subtitle at screen from_left(edge_px), screen from_top(24 + 24 * lines_of(shown_title)) left \
    font ',10' textcolor rgb quiet; \
    do for [i = 1:keys] { if (key_mark[i] > 0) { \
    set label 100 + i key_text[i] at screen from_left(key_left[i] + 5), screen from_top(key_top[i]) left offset 0.9, -0.2 \
    point pointtype key_mark[i] pointsize 1 linewidth 1.5 linecolor rgb key_colour[i] textcolor rgb key_colour[i] \
    } else { set label 100 + i key_text[i] at screen from_left(key_left[i] + mark_px), screen from_top(key_top[i]) left \
    textcolor rgb key_colour[i]; \
    set arrow 100 + i from screen from_left(key_left[i]), screen from_top(key_top[i]) to \
    screen from_left(key_left[i] + mark_px - 7), screen from_top(key_top[i]) nohead linewidth 2.5 \
    dashtype dash_of(key_mark[i]) linecolor rgb key_colour[i] } }"
# To be called after the first panel of a multiplot: each would draw the head again.
hide_head = "unset label 1; unset label 2; do for [i = 1:keys] { unset label 100 + i; if (key_mark[i] <= 0) { unset arrow 100 + i } }"

set border 3 linecolor rgb grey
set tics nomirror out scale 0.6 textcolor rgb ink
set grid xtics ytics back linetype 1 linewidth 1 linecolor rgb faint
unset key
# A panel of a multiplot, by the pixels of its frame; above it its title, and beside that what its curves are, each in its
# colour: `panel_names` and `panel_hues` are lists of words.
panel_names = panel_hues = ''
bold_letter_px = 9.1
panel(title, left_px, top_px, right_px, bottom_px) = sprintf('set lmargin at screen from_left(%g); \
    set rmargin at screen from_left(%g); set tmargin at screen from_top(%g); set bmargin at screen from_top(%g); \
    panel_x_px = %g; panel_title_px = %g; panel_title = "%s"; eval(panel_head)', left_px, right_px, top_px, bottom_px, left_px, \
    top_px - 12, title)
panel_head = "set label 10 panel_title at screen from_left(panel_x_px), screen from_top(panel_title_px) left \
    font bold(11) textcolor rgb ink; panel_x_px = panel_x_px + strlen(panel_title) * bold_letter_px + 12; \
    do for [i = 1:8] { unset label 40 + i }; do for [i = 1:words(panel_names)] { \
    set label 40 + i word(panel_names, i) at screen from_left(panel_x_px), screen from_top(panel_title_px) left \
    textcolor rgb word(panel_hues, i); panel_x_px = panel_x_px + strlen(word(panel_names, i)) * key_letter_px + 12 }"
# Rows with the names of the list `rows` on the left, a band behind every other one; panels begin at left_px.
longest(list) = (most_letters = 0, sum [i = 1:words(list)] (strlen(word(list, i)) > most_letters ? \
    (most_letters = strlen(word(list, i))) : 0), most_letters)
show_rows = "set yrange [words(rows) + 0.5:0.5]; set grid noytics; set ytics scale 0 (); left_px = edge_px + 16 + 9 * longest(rows); \
    do for [i = 1:words(rows)] { set ytics add (word(rows, i) i); if (i % 2) { set object 100 + i rectangle \
    from graph 0, first i - 0.5 to graph 1, first i + 0.5 behind fillcolor rgb '#f4f6f8' fillstyle solid noborder } }"
# Below 0 the device has given energy: said where there is room for it.
below_zero = "set object 1 rectangle from graph 0, graph 0 to graph 1, first 0 behind fillcolor rgb '#fdeeee' fillstyle solid \
    noborder; set label 12 'below 0: not passive' at graph 0.02, graph 0 left offset 0, 0.8 font ',10' textcolor rgb red"
energy(mJ) = abs(mJ) < 1e-6 ? '0' : sprintf(abs(mJ) < 100 ? '%.3g mJ' : '%.0f mJ', mJ)
no_data = "set label 11 'no data' at graph 0.5, graph 0.5 center textcolor rgb quiet; \
    plot [][0:1] NaN notitle; unset label 11"
