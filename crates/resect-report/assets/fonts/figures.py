#!/usr/bin/env python3
"""Makes Figures-Regular.otf: Inter's tabular figures, and a space and signs of their width.

egui asks no font for its features. In front of Inter in one family, these figures keep the columns of tables straight. Needs
fonttools:

    zstd -d Inter-Regular.otf.zst
    python3 figures.py Inter-Regular.otf Figures-Regular.otf
"""

import sys

from fontTools.pens.t2CharStringPen import T2CharStringPen
from fontTools.pens.transformPen import TransformPen
from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont

WANTED = "0123456789 +-\u2212\u00b1\u2013"

source, target = sys.argv[1:]
font = TTFont(source)
gsub = font["GSUB"].table
tabular = {}
for record in gsub.FeatureList.FeatureRecord:
    if record.FeatureTag == "tnum":
        for index in record.Feature.LookupListIndex:
            for table in gsub.LookupList.Lookup[index].SubTable:
                tabular.update(getattr(table, "ExtSubTable", table).mapping)
for table in font["cmap"].tables:
    table.cmap = {c: tabular.get(name, name) for c, name in table.cmap.items() if chr(c) in WANTED}
for tag in ("GSUB", "GPOS", "GDEF"):
    del font[tag]
options = Options()
options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14]
options.notdef_outline = True
subsetter = Subsetter(options)
subsetter.populate(unicodes=map(ord, WANTED))
subsetter.subset(font)

names = font.getBestCmap()
advance = font["hmtx"][names[ord("0")]][0]
glyphs, strings = font.getGlyphSet(), font["CFF "].cff[0].CharStrings
drawn = {}
for name in names.values():
    wide = font["hmtx"][name][0]
    # A glyph that is wider or narrower than a figure stands in the middle.
    factor = min(1.0, advance / wide)
    pen = T2CharStringPen(advance, None)
    glyphs[name].draw(TransformPen(pen, (factor, 0, 0, 1, (advance - factor * wide) / 2, 0)))
    drawn[name] = pen.getCharString(strings[name].private, strings[name].globalSubrs)
for name, string in drawn.items():
    strings[name] = string
    font["hmtx"][name] = (advance, 0)
for record in font["name"].names:
    if record.nameID in (1, 3, 4, 6):
        record.string = "Figures-Regular" if record.nameID in (3, 6) else "Figures"
font["head"].modified = font["head"].created
font.recalcTimestamp = False
font.save(target)
