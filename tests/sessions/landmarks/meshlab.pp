<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime time="12:00:00" date="2026-01-01"/>
  <DataFileName name="bar.stl"/>
 </DocumentData>
 <point x="0" y="0.5" z="0.5" name="foot" active="1"/>
 <point active="1" name="mid &amp; more" z="0.5" y="0.5" x="3"/>
 <point x="0" y="0" z="0" name="tip" active="0"/>
 <point x="1" y="1" z="1" active="1" name=""/>
</PickedPoints>
