"""How makers' numbers of gallium nitride and silicon carbide parts begin, a row for each maker, as ordering codes say.

Nothing else tells such parts in lists that give numbers alone. A row is a series, never a single part, and no number of
a silicon part of that maker fits it.
"""

GAN_TRANSISTORS = "|".join(
    (
        r"epc[278][0-9]{3,4}\w*",  # Efficient Power Conversion
        r"gs-?0[0-9]{2}-?[0-9]{3}\w*|gs6[16][0-9]{3}\w*",  # GaN Systems
        r"ig(o|t|l|d|ot|ld|lr|lt)[0-9]{2}r\w*|ig[bck][0-9]{3}[bs][0-9]\w*",  # Infineon, to 700 V and to 200 V
        r"tp(65|70|90|44|120)h[0-9]\w*|tph3[23][0-9]{2}\w*",  # Transphorm, now Renesas
        r"gan[be]?[0-9]\w*",  # Nexperia
        r"inn(30|40|80|100|120|150|200|650|700)[a-z][a-z0-9]*",  # Innoscience
        r"gn[ep][0-9]{4}\w*",  # ROHM
        r"sgt[0-9]{2,3}r[0-9]{2,3}[a-z]\w*",  # STMicroelectronics
        r"cgd65[ab][0-9]\w*",  # Cambridge GaN Devices
        r"pga26[ec]\w*",  # Panasonic
        r"cghv?[0-9]\w*|cg2h[0-9]\w*",  # Wolfspeed, now MACOM, for radio
        r"qpd[0-9]{4}\w*|tgf2[89][0-9]{2}\w*|npt[12][0-9]{3}\w*|clf1g[0-9]\w*",  # Qorvo, MACOM, Ampleon, for radio
        r"ganfets?",
    )
)
"""Transistors of gallium nitride."""

GAN_POWER_STAGES = "|".join(
    (
        r"lmg[2-7][0-9]{3}\w*",  # Texas Instruments; LMG1… only drive such transistors
        r"epc2(1[0-9]{2}|3[0-9]{3})\w*",  # Efficient Power Conversion
        r"nv6[0-9]{3}\w*",  # Navitas
        r"mastergan[0-9]\w*|vipergan[0-9]\w*",  # STMicroelectronics
        r"igi[0-9]{2}[a-z]\w*",  # Infineon
        r"bm3g[0-9]{3}\w*",  # ROHM
        r"isg[36][0-9]{3}\w*",  # Innoscience
    )
)
"""Circuits that have such transistors inside."""

SIC_TRANSISTORS = "|".join(
    (
        r"[ce][23]m[0-9]{7}\w*|c[a-d][a-z][0-9]{3}m(09|12|17|20|23|33)[a-z]\w*",  # Wolfspeed, single and modules
        r"sct[0-9]{2}n\w*|sct[a-z]{1,2}[0-9]+n[0-9]\w*|sct[0-9]{3}[a-z]{1,3}[0-9]{2,3}g[0-9]\w*",  # STMicroelectronics
        r"sct[234][0-9]{3}[a-z]{2}\w*|bsm[0-9]{3}[cd][0-9]{2}p[0-9][a-z]\w*",  # ROHM, single and modules
        r"a?im[a-z]{1,4}[0-9]{2,3}r[0-9]\w*",  # Infineon
        r"f(f|s|[34]l?-?)[0-9]{1,3}mr[0-9]{2}[a-z]\w*",  # Infineon's modules
        r"n[tv][a-z0-9]+n[0-9]{3}(sc[0-9]|m[1-4])\w*",  # onsemi
        r"nv?x[a-z][0-9]{2}s[0-9]{2}m[0-9]\w*|nxh[0-9]{3}[pft][0-9]{3}m\w*",  # onsemi's modules
        r"u[fgj][34](s?c|n)[0-9]\w*",  # UnitedSiC, later Qorvo, now onsemi
        r"msc[0-9]{3}sm\w*",  # Microchip
        r"lsic1mo\w*",  # Littelfuse
        r"g[2-4]r[0-9]+m\w*",  # GeneSiC, now Navitas
        r"tw[0-9]{3}[jnvz][0-9]\w*",  # Toshiba
        r"nsf[0-9]{6}[a-z]\w*",  # Nexperia
        r"gp[23]t[0-9]{3}a\w*|gcmx[0-9]\w*",  # SemiQ
        r"b[23]m[0-9]{6}\w*|bmf[0-9]{3}r[0-9]{2}\w*",  # BASiC
        r"p3m[0-9]{5}\w*|iv[123]q[0-9]{5}\w*",  # PN Junction, InventChip
        r"sicfets?",
    )
)
"""Transistors of silicon carbide, and modules of them."""

SIC_DIODES = "|".join(
    (
        r"[ce][3-6]d[0-9]{5}\w*|cvfd[0-9]{5}\w*|cpw[2-6]-[0-9]{4}\w*|csd(0[1246]|10|20)(060|120)[a-z]*",  # Wolfspeed
        r"scs[1-3][0-9]{2}[a-z]\w*",  # ROHM
        r"stpsc[0-9]\w*",  # STMicroelectronics
        r"a?id(h|k|l|m|v|w|dd|wd|yh)[0-9]{2,3}[gs][0-9]\w*",  # Infineon
        r"ffs[a-z][0-9]{4,5}\w*|nv?ds[a-z][0-9]{5}\w*",  # onsemi
        r"uj3d[0-9]\w*",  # UnitedSiC
        r"msc[0-9]{3}sd\w*",  # Microchip
        r"lsic2sd\w*",  # Littelfuse
        r"g[b-e][0-9]{2}(slt|mps)\w*",  # GeneSiC
        r"trs[0-9]{1,2}[aenv](65|120)\w*",  # Toshiba
        r"psc[0-9]{2}(65|120)[a-z]\w*",  # Nexperia
        r"vs-[34]?c[0-9]{2}[a-z]{2}[0-9]{2}\w*",  # Vishay
        r"wnsc[0-9]\w*",  # WeEn
        r"s[346]d[0-9]{5}\w*|b[123]d[0-9]{5}\w*",  # SMC, BASiC
        r"p[36]d[0-9]{5}\w*|iv1d[0-9]{5}\w*",  # PN Junction, InventChip
        r"dsc[0-9]{2}[ac][0-9]{3}\w*|bsd[a-z][0-9]{2}[gs][0-9]{2,3}\w*",  # Diodes Incorporated, Bourns
    )
)
"""Diodes of silicon carbide."""
