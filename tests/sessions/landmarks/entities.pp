<!DOCTYPE PickedPoints [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>
<PickedPoints><point x="0" y="0" z="0" name="&c;&c;"/></PickedPoints>
